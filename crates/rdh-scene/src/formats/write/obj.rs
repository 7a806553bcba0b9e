//! Wavefront OBJ: `v` and `f` lines, numbers as short as they can be without becoming others.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use super::Placed;

pub(super) fn write(placed: &Placed<'_>, out: &mut BufWriter<File>) -> io::Result<()> {
    if placed.origin == [0.0; 3] {
        placed.mesh.positions().iter().try_for_each(|[x, y, z]| writeln!(out, "v {x} {y} {z}"))?;
    } else {
        placed.world().try_for_each(|[x, y, z]| writeln!(out, "v {x} {y} {z}"))?;
    }
    let mut triangles = placed.mesh.triangles().iter().map(|t| t.map(|i| u64::from(i) + 1));
    triangles.try_for_each(|[a, b, c]| writeln!(out, "f {a} {b} {c}"))
}
