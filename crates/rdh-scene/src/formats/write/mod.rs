//! Writers of mesh files: what [`super::FORMATS`] read, as plainly as each format can say it. Triangles keep their order.

mod glb;
mod obj;
mod ply;
mod stl;

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use rdh::Mesh;

use crate::error::{Error, Result};
use crate::files::write_with;
use crate::scene::Note;

/// A format that can be written.
#[derive(Debug, Clone, Copy)]
pub struct Writer {
    /// Its name; also the usual file extension, in lower case.
    pub name: &'static str,
    write: fn(&Placed<'_>, &mut BufWriter<File>) -> io::Result<()>,
    /// Whether numbers far from zero survive.
    keeps_origin: bool,
}

/// The formats that can be written.
pub const WRITERS: &[Writer] = &[
    Writer { name: "obj", write: obj::write, keeps_origin: true },
    Writer { name: "ply", write: ply::write, keeps_origin: true },
    Writer { name: "stl", write: stl::write, keeps_origin: false },
    Writer { name: "glb", write: glb::write, keeps_origin: true },
];

/// A mesh and what its `[0, 0, 0]` is in world coordinates.
struct Placed<'a> {
    mesh: &'a Mesh,
    origin: [f64; 3],
}

impl Placed<'_> {
    /// The vertices in world coordinates.
    fn world(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.mesh.positions().iter().map(|&p| self.moved(p))
    }

    fn moved(&self, p: [f32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| self.origin[a] + f64::from(p[a]))
    }
}

/// Writes a mesh whose `[0, 0, 0]` is `origin` in world coordinates; the path's extension says in which format. What could not be
/// kept is said in notes.
///
/// # Errors
/// An extension that is not known, or what the system says; a file that was there stays as it was then.
pub fn write_file(path: &Path, mesh: &Mesh, origin: [f64; 3]) -> Result<Vec<Note>> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let writer = WRITERS.iter().find(|w| extension.as_deref() == Some(w.name)).ok_or_else(|| {
        let known: Vec<_> = WRITERS.iter().map(|w| w.name).collect();
        Error::whole(format!("meshes are written as {}", known.join(", "))).in_file(path)
    })?;
    let placed = Placed { mesh, origin };
    write_with(path, |out| (writer.write)(&placed, out)).map_err(|e| Error::whole(e.to_string()).in_file(path))?;
    let mut notes = super::notes::Notes::default();
    if !writer.keeps_origin && origin != [0.0; 3] {
        notes.add("vertices rounded to f32 far from zero", mesh.positions().len());
    }
    if let Some(masks) = mesh.masks() {
        notes.add("masks of triangles", masks.len());
    }
    Ok(notes.finish())
}
