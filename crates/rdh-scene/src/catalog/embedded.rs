//! The embedded scenes: one TOML per generator, with its views and its variants.
//!
//! To add a scene: a `[[scene]]` in its generator's TOML, then `RDH_GOLDEN=write cargo test -p rdh-scene --test catalog`
//! and a look at what changed in `tests/golden.toml`.
//!
//! How a scene's kind was chosen: *dense* if half or more of the shadow rays from what an eye sees are blocked, or if the
//! eye stands among things that hide most of the scene from it (Havran measured 80 % for lattice, 51 % for gears and
//! 47 % for rings; buildings, cities and forests are seen from within); *interior* if the eye is in an enclosed room that
//! hides little; *open* otherwise.

use serde::Deserialize;

use super::{Entry, Source};
use crate::camera::View;
use crate::error::{Error, Result};
use crate::generate;
use crate::scene::Kind;

/// The TOMLs, in the order of the list of scenes.
const FAMILIES: &[(&str, &str)] = &[
    ("balls.toml", include_str!("../../scenes/balls.toml")),
    ("gears.toml", include_str!("../../scenes/gears.toml")),
    ("jacks.toml", include_str!("../../scenes/jacks.toml")),
    ("lattice.toml", include_str!("../../scenes/lattice.toml")),
    ("mount.toml", include_str!("../../scenes/mount.toml")),
    ("rings.toml", include_str!("../../scenes/rings.toml")),
    ("shells.toml", include_str!("../../scenes/shells.toml")),
    ("sombrero.toml", include_str!("../../scenes/sombrero.toml")),
    ("teapot.toml", include_str!("../../scenes/teapot.toml")),
    ("tetra.toml", include_str!("../../scenes/tetra.toml")),
    ("tree.toml", include_str!("../../scenes/tree.toml")),
    ("building.toml", include_str!("../../scenes/building.toml")),
    ("city.toml", include_str!("../../scenes/city.toml")),
    ("forest.toml", include_str!("../../scenes/forest.toml")),
    ("terrain.toml", include_str!("../../scenes/terrain.toml")),
];

/// What a TOML says of a generator.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Family {
    generator: String,
    kind: Kind,
    about: String,
    /// Views that fit every variant, after the generator's own.
    #[serde(default)]
    view: Vec<View>,
    scene: Vec<Variant>,
}

/// A scene: a generator with some parameters.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Variant {
    id: String,
    parameters: toml::Table,
    /// Its triangles, as a test checks.
    triangles: usize,
    /// What is said instead of the generator's line.
    about: Option<String>,
    kind: Option<Kind>,
    #[serde(default)]
    quick: bool,
    frames: Option<u32>,
    /// Views that only this variant has.
    #[serde(default)]
    view: Vec<View>,
}

/// The embedded scenes, in order.
///
/// # Errors
/// None in a released program: the embedded tables are tested.
pub fn embedded() -> Result<Vec<Entry>> {
    let mut entries = Vec::new();
    for family in families() {
        let family = family?;
        for variant in &family.scene {
            entries.push(family.entry(variant)?);
        }
    }
    Ok(entries)
}

/// An entry for a generator with parameters that no embedded scene has.
pub(super) fn parametrised(table: toml::Table) -> Result<Entry> {
    let scene = generate::make(&table, 0)?;
    let id = generate::format_call(&table);
    let name = table.get("generator").and_then(toml::Value::as_str).unwrap_or_default();
    for family in families() {
        let family = family?;
        if family.generator == name {
            let views = scene.views.iter().chain(&family.view).cloned().collect();
            return Ok(Entry {
                id,
                kind: family.kind,
                triangles: scene.triangle_count(),
                about: family.about,
                views,
                frames: 1,
                quick: false,
                source: Source::Generator(table),
            });
        }
    }
    Err(Error::at(id, "the generator has no TOML"))
}

fn families() -> impl Iterator<Item = Result<Family>> {
    FAMILIES.iter().map(|(file, text)| toml::from_str(text).map_err(|e| Error::whole(e.to_string()).in_file(file)))
}

impl Family {
    fn entry(&self, variant: &Variant) -> Result<Entry> {
        let mut table = variant.parameters.clone();
        table.insert("generator".to_owned(), toml::Value::String(self.generator.clone()));
        let mut views = generate::views(&table)?;
        views.extend(self.view.iter().chain(&variant.view).cloned());
        Ok(Entry {
            id: variant.id.clone(),
            kind: variant.kind.unwrap_or(self.kind),
            triangles: variant.triangles,
            about: variant.about.clone().unwrap_or_else(|| self.about.clone()),
            views,
            frames: variant.frames.unwrap_or(1),
            quick: variant.quick,
            source: Source::Generator(table),
        })
    }
}
