//! What is in mesh files: a table for people who want to know what was read.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::{FORMATS, read_file};
use crate::error::{Error, Result};
use crate::scene::Note;

/// What is in one file.
#[derive(Debug, Clone)]
pub struct Row {
    /// The file.
    pub path: PathBuf,
    /// Triangles of all instances.
    pub triangles: usize,
    /// Those among them whose area is exactly zero in their own space.
    pub zero_area: usize,
    /// Triangles stored, each geometry counted once.
    pub unique_triangles: usize,
    /// How many geometries stand somewhere.
    pub instances: usize,
    /// How many of these are mirrored.
    pub mirrored: usize,
    /// The scene's origin.
    pub origin: [f64; 3],
    /// What was dropped or repaired.
    pub notes: Vec<Note>,
    /// How long reading took, in seconds of real time.
    pub read_secs: f64,
}

/// Reads a file and says what is in it.
///
/// # Errors
/// As of [`read_file`].
pub fn inventory(path: &Path) -> Result<Row> {
    let start = Instant::now();
    let scene = read_file(path)?;
    let read_secs = start.elapsed().as_secs_f64();
    Ok(Row {
        path: path.to_owned(),
        triangles: scene.triangle_count(),
        zero_area: scene.zero_area_count(),
        unique_triangles: scene.geometries.iter().map(|g| g.triangles.len()).sum(),
        instances: scene.instances.len(),
        mirrored: scene.instances.iter().filter(|i| i.scene_from_object.mirrors()).count(),
        origin: scene.origin,
        notes: scene.notes,
        read_secs,
    })
}

/// The files of a folder and of its subfolders that have the extension of a known format, sorted.
///
/// # Errors
/// A folder that can't be listed.
pub fn mesh_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut folders = vec![folder.to_owned()];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        let failed = |e: std::io::Error| Error::whole(e.to_string()).in_file(&folder);
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            // A linked folder could contain itself: only real ones are entered.
            if entry.file_type().map_err(failed)?.is_dir() {
                folders.push(entry.path());
            } else if is_known(&entry.path()) {
                files.push(entry.path());
            }
        }
    }
    files.sort();
    Ok(files)
}

fn is_known(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    FORMATS.iter().any(|f| extension.eq_ignore_ascii_case(f.name))
}
