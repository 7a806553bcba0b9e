//! A folder's `scenes.toml`: which of its files make up which scene, and from where it is looked at.
//!
//! ```toml
//! [[scene]]
//! id = "courtyard"
//! files = ["walls.glb", "plants.glb"]     # joined; beneath the folder
//! format = "glb"
//! triangles = 1234                        # all instances counted
//! up_axis = "Z"
//! character = "One line about it"         # optional, as all that follow are
//! kind = "interior"                       # open, interior or dense; see below
//! light = [1.0, 2.0, 3.0]                 # a point light
//! frames = 24                             # of the files' first animation; 1 if nothing is to move
//! frame_secs = 0.04                       # between frames; 1/24 unless given
//!   [[scene.view]]
//!   name = "gate"
//!   eye = [1.0, 2.0, 3.0]
//!   target = [0.0, 0.0, 0.0]
//!   up = [0, 0, 1]
//!   fov_y_degrees = 60
//!   hit_fraction_16_9 = 0.9               # optional: the share of primary rays that hit something
//! ```
//! `licence`, `attribution`, `source`, `changes`, `bounds_min` and `bounds_max` may be there too, for people, and so may
//! `[[format_sample]]` tables. Any other key is an error.
//!
//! Where `kind` is missing: `open` if fewer than 0.6 of some view's rays hit; else `dense` if the character speaks of
//! "occluded" or "rooms"; else `interior`.

use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use crate::camera::View;
use crate::catalog::{Entry, Source};
use crate::error::{Error, Result};
use crate::formats::{self, FORMATS, text};
use crate::scene::{Kind, PointLight, Scene};

/// The file's name in its folder.
pub const FILE_NAME: &str = "scenes.toml";

/// Seconds between frames, unless an index says otherwise.
const FILM: f64 = 1.0 / 24.0;

/// A scene of mesh files.
#[derive(Debug, Clone, PartialEq)]
pub struct Files {
    /// The files, to be joined.
    pub paths: Vec<PathBuf>,
    /// Which direction is up; without it, the one that goes with the format of the first file.
    pub up: Option<[f64; 3]>,
    /// A point light, in world coordinates.
    pub light: Option<[f64; 3]>,
    /// Seconds from one frame to the next.
    pub frame_secs: f64,
}

impl Files {
    /// Files of which no index says anything.
    pub fn of(paths: Vec<PathBuf>) -> Self {
        Self { paths, up: None, light: None, frame_secs: FILM }
    }

    /// Reads the files: frame 0 is at rest, frame 1 the start of the first animation.
    ///
    /// # Errors
    /// What the readers say.
    pub fn load(&self, frame: u32) -> Result<Scene> {
        let time_secs = frame.checked_sub(1).map(|frames| f64::from(frames) * self.frame_secs);
        let mut scene = formats::read_files_at(&self.paths, time_secs)?;
        scene.up = self.up.unwrap_or(scene.up);
        scene.lights = self.light.map(|position| PointLight { position }).into_iter().collect();
        Ok(scene)
    }
}

/// The scenes of a folder's index, in order.
///
/// # Errors
/// A missing or malformed index, by line.
pub fn read_index(folder: &Path) -> Result<Vec<Entry>> {
    let path = folder.join(FILE_NAME);
    let text = std::fs::read_to_string(&path).map_err(|e| Error::whole(e.to_string()).in_file(&path))?;
    entries(&text, folder).map_err(|e| e.in_file(&path))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Index {
    #[serde(default)]
    scene: Vec<Row>,
    #[serde(default, rename = "format_sample")]
    _format_sample: Vec<toml::Table>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    id: Spanned<String>,
    files: Vec<Spanned<String>>,
    format: Spanned<String>,
    triangles: usize,
    up_axis: Axis,
    #[serde(default)]
    character: String,
    kind: Option<Kind>,
    light: Option<[f64; 3]>,
    #[serde(default = "one")]
    frames: Spanned<u32>,
    #[serde(default = "film")]
    frame_secs: Spanned<f64>,
    #[serde(default)]
    view: Vec<Spanned<ViewRow>>,
    #[serde(rename = "licence")]
    _licence: Option<String>,
    #[serde(rename = "attribution")]
    _attribution: Option<String>,
    #[serde(rename = "source")]
    _source: Option<String>,
    #[serde(rename = "changes")]
    _changes: Option<String>,
    #[serde(rename = "bounds_min")]
    _bounds_min: Option<[f64; 3]>,
    #[serde(rename = "bounds_max")]
    _bounds_max: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ViewRow {
    name: String,
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov_y_degrees: f64,
    hit_fraction_16_9: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
enum Axis {
    X,
    Y,
    Z,
}

fn one() -> Spanned<u32> {
    Spanned::new(0..0, 1)
}

fn film() -> Spanned<f64> {
    Spanned::new(0..0, FILM)
}

fn entries(text: &str, folder: &Path) -> Result<Vec<Entry>> {
    let index: Index = toml::from_str(text).map_err(|e| at(text, e.span().unwrap_or_default(), e.message()))?;
    let mut entries: Vec<Entry> = Vec::new();
    for row in index.scene {
        if entries.iter().any(|e| e.id == *row.id.get_ref()) {
            return Err(at(text, row.id.span(), &format!("scene '{}' is there twice", row.id.get_ref())));
        }
        entries.push(entry(row, folder).map_err(|(span, reason)| at(text, span, &reason))?);
    }
    Ok(entries)
}

fn at(text: &str, span: Range<usize>, reason: &str) -> Error {
    Error::at(text::line_of(text.as_bytes(), span.start), reason)
}

/// Where in the text, and what is wrong there.
type Fault = (Range<usize>, String);

fn entry(row: Row, folder: &Path) -> Result<Entry, Fault> {
    check_row(&row)?;
    let kind = row.kind.unwrap_or_else(|| guess_kind(&row));
    let up = match row.up_axis {
        Axis::X => [1.0, 0.0, 0.0],
        Axis::Y => [0.0, 1.0, 0.0],
        Axis::Z => [0.0, 0.0, 1.0],
    };
    let paths = row.files.iter().map(|file| folder.join(file.get_ref())).collect();
    let source =
        Source::Files(Files { paths, up: Some(up), light: row.light, frame_secs: row.frame_secs.into_inner() });
    let mut views: Vec<View> = Vec::new();
    for view in row.view {
        let span = view.span();
        let view = checked_view(view.into_inner()).map_err(|reason| (span.clone(), reason))?;
        if views.iter().any(|v| v.name == view.name) {
            return Err((span, format!("view '{}' is there twice", view.name)));
        }
        views.push(view);
    }
    Ok(Entry {
        id: row.id.into_inner(),
        kind,
        triangles: row.triangles,
        about: row.character,
        views,
        frames: row.frames.into_inner(),
        quick: false,
        source,
    })
}

fn check_row(row: &Row) -> Result<(), Fault> {
    let id = row.id.get_ref();
    if id.is_empty() || id.contains([':', '/', '\\']) || id.contains(char::is_whitespace) {
        return Err((row.id.span(), format!("id '{id}' must be one word without ':' and slashes")));
    }
    if !FORMATS.iter().any(|f| f.name == row.format.get_ref()) {
        let known: Vec<_> = FORMATS.iter().map(|f| f.name).collect();
        let reason = format!("unknown format '{}'; the known ones are {}", row.format.get_ref(), known.join(", "));
        return Err((row.format.span(), reason));
    }
    if row.files.is_empty() || row.view.is_empty() {
        return Err((row.id.span(), format!("scene '{id}' needs at least one file and one view")));
    }
    if let Some(file) = row.files.iter().find(|file| !lies_beneath(file.get_ref())) {
        return Err((file.span(), format!("file '{}' must lie beneath the index's folder", file.get_ref())));
    }
    if *row.frames.get_ref() == 0 {
        return Err((row.frames.span(), "a scene has at least one frame".to_owned()));
    }
    let secs = *row.frame_secs.get_ref();
    if !(secs > 0.0 && secs.is_finite()) {
        return Err((row.frame_secs.span(), format!("frame_secs is {secs}; it must be above 0")));
    }
    match row.light {
        Some(light) if !light.iter().all(|x| x.is_finite()) => {
            Err((row.id.span(), format!("the light of scene '{id}' is not finite")))
        }
        _ => Ok(()),
    }
}

/// Whether a path leads downwards only.
fn lies_beneath(file: &str) -> bool {
    !file.is_empty() && Path::new(file).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
}

fn checked_view(row: ViewRow) -> Result<View, String> {
    let ViewRow { name, eye, target, up, fov_y_degrees, .. } = row;
    let finite = [eye, target, up].as_flattened().iter().all(|x| x.is_finite());
    let wrong = if name.is_empty() {
        "needs a name"
    } else if !finite {
        "has a coordinate that is not finite"
    } else if eye == target {
        "looks at its own eye"
    } else if up == [0.0; 3] {
        "has no up direction"
    } else if !(fov_y_degrees > 0.0 && fov_y_degrees < 180.0) {
        "needs an angle of view between 0 and 180 degrees"
    } else {
        return Ok(View { name, eye, target, up, fov_y_degrees });
    };
    Err(format!("view '{name}' {wrong}"))
}

/// The rule of the module's documentation.
fn guess_kind(row: &Row) -> Kind {
    let mostly_missed = |view: &Spanned<ViewRow>| view.get_ref().hit_fraction_16_9.is_some_and(|hit| hit < 0.6);
    if row.view.iter().any(mostly_missed) {
        Kind::Open
    } else if ["occluded", "rooms"].iter().any(|word| row.character.contains(word)) {
        Kind::Dense
    } else {
        Kind::Interior
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INDEX: &str = r#"[[scene]]
id = "hall"
files = ["hall.ply", "parts/door.ply"]
format = "ply"
triangles = 12
up_axis = "Z"
licence = "CC0-1.0"
character = "Many rooms"
light = [1, 2, 3]
  [[scene.view]]
  name = "in"
  eye = [0, 0, 1]
  target = [1.5, 0, 1]
  up = [0, 0, 1]
  fov_y_degrees = 60
  hit_fraction_16_9 = 1.000
"#;

    #[test]
    fn reads_an_index() {
        let entries = entries(INDEX, Path::new("folder")).unwrap();
        let [hall] = &entries[..] else { panic!("{entries:?}") };
        assert_eq!((hall.id.as_str(), hall.kind, hall.triangles, hall.frames), ("hall", Kind::Dense, 12, 1));
        assert_eq!(hall.views[0].target, [1.5, 0.0, 1.0]);
        let Source::Files(files) = &hall.source else { panic!("{:?}", hall.source) };
        assert_eq!(files.paths[1], Path::new("folder/parts/door.ply"));
        assert_eq!((files.up, files.light), (Some([0.0, 0.0, 1.0]), Some([1.0, 2.0, 3.0])));
    }

    #[test]
    fn the_kind_is_guessed_as_documented() {
        let kind = |from: &str, to: &str| entries(&INDEX.replace(from, to), Path::new("")).unwrap()[0].kind;
        assert_eq!(kind("1.000", "0.599"), Kind::Open);
        assert_eq!(kind("Many rooms", "A hall"), Kind::Interior);
        assert_eq!(kind("light =", "kind = \"open\"\nlight ="), Kind::Open);
    }

    #[test]
    fn errors_name_the_line() {
        let error = |from: &str, to: &str| entries(&INDEX.replace(from, to), Path::new("")).unwrap_err().to_string();
        let starts = [
            ("licence", "license", "line 7: unknown field `license`"),
            ("\"hall\"", "\"a hall\"", "line 2: id 'a hall'"),
            ("parts/", "../", "line 3: file '../door.ply'"),
            ("\"ply\"", "\"PLY\"", "line 4: unknown format 'PLY'; the known ones are obj,"),
            ("12", "-12", "line 5: "),
            ("up_axis = \"Z\"", "up_axis = \"up\"", "line 6: unknown variant `up`"),
            ("60", "nan", "line 10: view 'in' needs an angle"),
            ("[1.5, 0, 1]", "[0, 0, 1]", "line 10: view 'in' looks at its own eye"),
            ("id =", "id", "line 2: "),
        ];
        for (from, to, start) in starts {
            let error = error(from, to);
            assert!(error.starts_with(start), "{error}");
        }
        let twice = format!("{INDEX}{INDEX}");
        let error = entries(&twice, Path::new("")).unwrap_err().to_string();
        assert_eq!(error, "line 18: scene 'hall' is there twice");
    }
}
