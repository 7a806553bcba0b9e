//! Readers of mesh files.
//!
//! Each format is one module with `read(&[u8], &Context) -> Result<Scene>` and one row in [`FORMATS`]. A reader keeps
//! every triangle (those of zero area too, so that counts agree with other programs), says in [`Scene::notes`] what it
//! dropped, and answers bad data with an error that names the place. Files are not trusted: no claim of a file is
//! believed before the bytes for it are there, and nothing recurses on data.
//!
//! Coordinates are read as f64 and stored relative to [`Scene::origin`]; `origin.rs` states when that isn't zero.

mod assemble;
mod gltf;
mod grow;
mod inventory;
mod join;
mod notes;
mod obj;
mod origin;
mod ply;
mod stl;
pub(crate) mod text;
mod tree;
mod write;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::scene::Scene;

pub use inventory::{Row, inventory, mesh_files};
pub use write::{WRITERS, Writer, write_file};

/// A mesh file format.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// Its name in indexes and messages; also the usual file extension, in lower case.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Reads a file's bytes.
    pub read: fn(&[u8], &Context) -> Result<Scene>,
}

/// What a reader may need beside the bytes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Context<'a> {
    /// The folder in which the files lie that this one may refer to; without it, it may refer to none.
    pub folder: Option<&'a Path>,
    /// The moment of the first animation to show, in seconds; `None` is the scene at rest.
    pub time_secs: Option<f64>,
}

/// The formats that can be read.
pub const FORMATS: &[Format] = &[
    Format { name: "obj", about: "Wavefront OBJ: polygons; no curves", read: obj::read },
    Format { name: "ply", about: "PLY: ascii, binary little or big endian", read: ply::read },
    Format { name: "stl", about: "STL: ascii or binary", read: stl::read },
    Format { name: "gltf", about: "glTF 2.0 with external or embedded buffers", read: gltf::read },
    Format { name: "glb", about: "glTF 2.0 in one binary file", read: gltf::read },
    Format { name: "rdh", about: "a saved tree: the mesh in it", read: tree::read },
];

/// A scene of one mesh that comes from no file.
pub(crate) fn place(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Scene> {
    let part = assemble::Part { positions, triangles, ..assemble::Part::default() };
    assemble::assemble(vec![part], [0.0, 0.0, 1.0], Vec::new())
}

/// The format of a file, by its extension in any case.
///
/// # Errors
/// No or an unknown extension; the message lists the known ones.
pub fn format_of(path: &Path) -> Result<&'static Format> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    FORMATS.iter().find(|f| extension.as_deref() == Some(f.name)).ok_or_else(|| {
        let known: Vec<_> = FORMATS.iter().map(|f| f.name).collect();
        let found =
            extension.map_or_else(|| "no file extension".to_owned(), |e| format!("unknown file extension '{e}'"));
        Error::whole(format!("{found}; the known ones are {}", known.join(", "))).in_file(path)
    })
}

/// Reads a mesh file at rest.
///
/// # Errors
/// What can't be opened or read, naming the file and the place in it.
pub fn read_file(path: &Path) -> Result<Scene> {
    read_file_at(path, None)
}

/// Reads a mesh file at a moment of its first animation, in seconds; before its start and after its end it stands
/// still. Without a time, or in a format without animations, it is at rest.
///
/// # Errors
/// What can't be opened or read, naming the file and the place in it.
pub fn read_file_at(path: &Path, time_secs: Option<f64>) -> Result<Scene> {
    let format = format_of(path)?;
    let read = || {
        let bytes = read_bytes(path)?;
        (format.read)(&bytes, &Context { folder: path.parent(), time_secs })
    };
    let mut scene = read().map_err(|e: Error| e.in_file(path))?;
    scene.name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(scene)
}

/// Reads several mesh files into one scene with one origin, in order.
///
/// # Errors
/// What can't be opened or read, naming the file and the place in it.
pub fn read_files(paths: &[PathBuf]) -> Result<Scene> {
    read_files_at(paths, None)
}

/// As [`read_files`], at a moment as in [`read_file_at`].
///
/// # Errors
/// What can't be opened or read, naming the file and the place in it.
pub fn read_files_at(paths: &[PathBuf], time_secs: Option<f64>) -> Result<Scene> {
    join::join(paths.iter().map(|path| read_file_at(path, time_secs)))
}

/// A regular file's bytes. Devices and pipes have no size to trust, and are refused.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let failed = |e: std::io::Error| Error::whole(e.to_string()).in_file(path);
    // Asked before opening, since opening a pipe waits for its writer.
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err(Error::whole("is not a file").in_file(path));
    }
    let size = usize::try_from(about.len()).map_err(|_| Error::whole("is too large").in_file(path))?;
    let mut bytes = Vec::new();
    grow::reserve(&mut bytes, size).map_err(|e| e.in_file(path))?;
    File::open(path).and_then(|f| f.take(size as u64).read_to_end(&mut bytes)).map_err(failed)?;
    Ok(bytes)
}
