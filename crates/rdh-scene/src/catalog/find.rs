//! From what a user typed to a scene.

use std::path::Path;

use super::embedded::{embedded, parametrised};
use super::near::near_names;
use super::overview::overview;
use super::{Entry, Source};
use crate::error::{Error, Result};
use crate::formats::{self, FORMATS};
use crate::generate;
use crate::index::Files;
use crate::scene::Kind;

/// The scene that a text names: an embedded id (`balls4`), an id among `extra` (`country-kitchen`), a generator or an
/// embedded id with parameters (`building(floors=6,seed=3)`, `balls4(resolution=4)`), or a path to an OBJ, PLY, STL,
/// glTF or GLB file or a saved tree, which is read to place its views.
///
/// # Errors
/// An unknown id, naming near ones; parameters that the generator refuses; a file that cannot be read.
pub fn find(text: &str, extra: &[Entry]) -> Result<Entry> {
    let text = text.trim();
    let embedded = embedded()?;
    if let Some(entry) = embedded.iter().chain(extra).find(|e| e.id == text) {
        return Ok(entry.clone());
    }
    if is_mesh_file(text) {
        return file(Path::new(text));
    }
    let name = text.split('(').next().unwrap_or(text).trim();
    if generate::names().any(|known| known == name) {
        return parametrised(generate::parse_call(text)?);
    }
    let variant = embedded.iter().find(|e| e.id == name && text != name);
    if let Some(Source::Generator(base)) = variant.map(|e| &e.source) {
        return parametrised(overridden(base, generate::parse_call(text)?));
    }
    Err(unknown(text, name, embedded.iter().chain(extra)))
}

/// Splits `scene:view` at the view's colon; a text without one is all scene. Brackets, paths and Windows' drive letters
/// are left alone.
pub fn split_view(text: &str) -> (&str, Option<&str>) {
    match text.rsplit_once(':') {
        Some((scene, view))
            if scene.len() > 1 && !view.is_empty() && !view.contains(['/', '\\', ')']) && !is_mesh_file(view) =>
        {
            (scene, Some(view))
        }
        _ => (text, None),
    }
}

fn overridden(base: &toml::Table, call: toml::Table) -> toml::Table {
    let mut table = base.clone();
    table.extend(call.into_iter().filter(|(key, _)| key != "generator"));
    table
}

fn is_mesh_file(text: &str) -> bool {
    let ending = Path::new(text).extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    ending.is_some_and(|e| FORMATS.iter().any(|format| format.name == e))
}

/// An entry for a mesh file: read once, for its size and for views that fit its box.
fn file(path: &Path) -> Result<Entry> {
    if !path.is_file() {
        return Err(Error::whole("there is no such file").in_file(path));
    }
    let paths = vec![path.to_path_buf()];
    let scene = formats::read_files(&paths)?;
    Ok(Entry {
        id: path.display().to_string(),
        kind: Kind::Open,
        triangles: scene.triangle_count(),
        about: String::new(),
        views: if scene.views.is_empty() { overview(&scene) } else { scene.views },
        frames: 1,
        quick: false,
        source: Source::Files(Files::of(paths)),
    })
}

fn unknown<'a>(text: &str, name: &str, entries: impl Iterator<Item = &'a Entry>) -> Error {
    let mut known: Vec<&str> = entries.map(|e| e.id.as_str()).collect();
    generate::names().for_each(|name| known.push(name));
    let near = near_names(name, &known);
    let hint = if near.is_empty() {
        "`rdh scenes` lists them; a mesh file ends in .obj, .ply, .stl, .gltf or .glb, a saved tree in .rdh".to_owned()
    } else {
        format!("near names: {}", near.join(", "))
    };
    Error::whole(format!("there is no scene `{text}`; {hint}"))
}
