//! Files of meshes, rays and answers; `engines/README.md` states their format.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use rdh::{Mesh, Ray};

/// Writes a mesh file.
pub(crate) fn write_mesh(path: &Path, mesh: &Mesh) -> io::Result<()> {
    let counts = [mesh.positions().len(), mesh.triangles().len()];
    write(path, b"RDH-MESH", &counts, |out| {
        mesh.positions().as_flattened().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
        mesh.triangles().as_flattened().iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))
    })
}

/// Writes a ray file.
pub(crate) fn write_rays(path: &Path, rays: &[Ray]) -> io::Result<()> {
    write(path, b"RDH-CAST", &[rays.len()], |out| {
        for ray in rays {
            let (ends, lines) = ([ray.t_min, ray.t_max], [ray.origin, ray.direction]);
            lines.as_flattened().iter().chain(&ends).try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
        }
        Ok(())
    })
}

/// Reads a file of answers.
pub(crate) fn read_answers(path: &Path) -> io::Result<Vec<f32>> {
    let bytes = std::fs::read(path).map_err(|e| named(path, e))?;
    Ok(bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect())
}

fn write(
    path: &Path,
    magic: &[u8; 8],
    counts: &[usize],
    body: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let write = || {
        let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
        out.write_all(magic)?;
        counts.iter().try_for_each(|&n| out.write_all(&(n as u64).to_le_bytes()))?;
        body(&mut out)?;
        out.flush()
    };
    write().map_err(|e| named(path, e))
}

fn named(path: &Path, error: io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}
