//! PLY, binary little endian: floats, or doubles where the origin is not zero.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use super::Placed;

pub(super) fn write(placed: &Placed<'_>, out: &mut BufWriter<File>) -> io::Result<()> {
    let near = placed.origin == [0.0; 3];
    let number = if near { "float" } else { "double" };
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", placed.mesh.positions().len())?;
    ["x", "y", "z"].iter().try_for_each(|axis| writeln!(out, "property {number} {axis}"))?;
    writeln!(out, "element face {}", placed.mesh.len())?;
    writeln!(out, "property list uchar uint vertex_indices\nend_header")?;
    if near {
        let numbers = placed.mesh.positions().as_flattened();
        numbers.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
    } else {
        placed.world().flatten().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
    }
    placed.mesh.triangles().iter().try_for_each(|triangle| {
        out.write_all(&[3])?;
        out.write_all(triangle.map(u32::to_le_bytes).as_flattened())
    })
}
