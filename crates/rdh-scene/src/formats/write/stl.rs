//! STL, binary: each triangle with its normal and its corners; which corners are one vertex is not kept.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use rdh::TriId;

use super::Placed;

const HEADER: usize = 80;

pub(super) fn write(placed: &Placed<'_>, out: &mut BufWriter<File>) -> io::Result<()> {
    let mut header = [b' '; HEADER];
    header[..11].copy_from_slice(b"binary STL,");
    out.write_all(&header)?;
    out.write_all(&(placed.mesh.len() as u32).to_le_bytes())?;
    (0..placed.mesh.len() as u32).try_for_each(|id| {
        let corners = placed.mesh.corners(TriId(id)).map(|corner| placed.moved(corner));
        let numbers = [normal(corners)].into_iter().chain(corners).flatten();
        numbers.map(|x| x as f32).try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
        out.write_all(&[0; 2])
    })
}

/// Of length 1, on the side from which the corners run anticlockwise; zero if there is none.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let side = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let ([ux, uy, uz], [vx, vy, vz]) = (side(b), side(c));
    let n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { n.map(|x| x / length) } else { [0.0; 3] }
}
