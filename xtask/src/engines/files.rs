//! Mesh and ray files; `engines/README.md` states their format.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};
use rdh::{Mesh, Ray};

/// Writes a mesh file.
pub(crate) fn write_mesh(path: &Path, mesh: &Mesh) -> Result<()> {
    let counts = [mesh.positions().len(), mesh.triangles().len()];
    write(path, b"RDH-MESH", &counts, |out| {
        for x in mesh.positions().as_flattened() {
            out.write_all(&x.to_le_bytes())?;
        }
        mesh.triangles().as_flattened().iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))
    })
}

/// Writes a ray file.
pub(crate) fn write_rays(path: &Path, rays: &[Ray]) -> Result<()> {
    write(path, b"RDH-CAST", &[rays.len()], |out| {
        for ray in rays {
            let numbers: &[f32; 9] = bytemuck::cast_ref(ray);
            numbers[..8].iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
        }
        Ok(())
    })
}

fn write(
    path: &Path,
    magic: &[u8; 8],
    counts: &[usize],
    body: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<()> {
    let write = || {
        let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
        out.write_all(magic)?;
        counts.iter().try_for_each(|&n| out.write_all(&(n as u64).to_le_bytes()))?;
        body(&mut out)?;
        out.flush()
    };
    write().with_context(|| path.display().to_string())
}
