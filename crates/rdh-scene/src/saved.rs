//! Saved trees as files: written whole, and mapped where they lie, so that all processes of a machine share one copy.

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use memmap2::{Mmap, MmapOptions};
use rdh::Accel;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::camera::View;
use crate::error::{Error, Result};
use crate::files::write_with;
use crate::scene::Scene;

/// Writes a tree as a `.rdh` file.
///
/// # Errors
/// What the system says; a file that was there stays as it was then.
pub fn save(accel: &Accel, path: &Path) -> Result<()> {
    write_with(path, |out| accel.write_to(out)).map_err(|e| Error::whole(e.to_string()).in_file(path))
}

/// Opens a `.rdh` file: maps it, checks all of it, and uses it where it lies. O(file).
///
/// The file must not be changed while it is open: to replace it, rename another one over it, as [`save`] does. (A process that
/// reads from a mapped file which was cut off is killed by the system.)
///
/// # Errors
/// A file that can't be opened, or is no sound tree; the byte is named.
pub fn open(path: &Path) -> Result<Accel> {
    let wrong = |e: rdh::Error| Error::from(e).in_file(path);
    match map(path)? {
        Some(map) => Accel::from_shared(Arc::new(map)).map_err(wrong),
        None => open_copy(path),
    }
}

/// [`open`], read into memory of this process: independent of the file from then on, and on large pages where the system has them, which
/// makes incoherent rays through large trees a few percent faster.
///
/// # Errors
/// As [`open`].
pub fn open_copy(path: &Path) -> Result<Accel> {
    let bytes = crate::formats::read_bytes(path)?;
    Accel::from_bytes(&bytes).map_err(|e| Error::from(e).in_file(path))
}

/// A file's bytes where they lie; nothing where there are none to be mapped.
#[allow(unsafe_code, reason = "a mapped file is the one way to share a tree between processes")]
fn map(path: &Path) -> Result<Option<Mmap>> {
    let failed = |e: std::io::Error| Error::whole(e.to_string()).in_file(path);
    // Asked before opening, since opening a pipe waits for its writer.
    let about = fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err(Error::whole("is not a file").in_file(path));
    }
    let file = File::open(path).map_err(failed)?;
    // SAFETY: the bytes are only read. That nobody changes them meanwhile can't be enforced: it is asked of the users of `open`, and
    // kept by `save`, which never writes into a file that is there. Every index that is read from them is checked when it is used.
    let map = unsafe { MmapOptions::new().populate().map(&file) };
    // Some file systems can't map; then the file is read.
    Ok(map.ok().filter(|map| !map.is_empty()))
}

impl From<rdh::Error> for Error {
    fn from(error: rdh::Error) -> Self {
        match error {
            rdh::Error::Format { offset, reason } => Self::at(format!("byte {offset}"), reason),
            other => Self::whole(other.to_string()),
        }
    }
}

/// Which scene a tree was built for, and how it is looked at: kept among the settings of a saved tree, under `scene`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// The scene's id.
    pub id: String,
    /// What `[0, 0, 0]` of the tree is in world coordinates: rays that are given in those are moved by it.
    pub origin: [f64; 3],
    /// Which direction is up.
    pub up: [f64; 3],
    /// The scene's views, in world coordinates.
    pub views: Vec<View>,
}

impl Setting {
    /// That of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self { id: scene.name.clone(), origin: scene.origin, up: scene.up, views: scene.views.clone() }
    }

    /// That of a tree's settings; trees that others made need not have one.
    pub fn from_settings(settings: &Value) -> Option<Self> {
        let setting: Self = serde_json::from_value(settings.get("scene")?.clone()).ok()?;
        let numbers = setting.views.iter().flat_map(|v| [v.eye, v.target, v.up, [v.fov_y_degrees; 3]]);
        numbers.chain([setting.origin, setting.up]).flatten().all(f64::is_finite).then_some(setting)
    }
}
