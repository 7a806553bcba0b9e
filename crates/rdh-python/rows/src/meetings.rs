//! Where rays and the triangles that they hit meet, in double precision.

use rdh::Hit;

use crate::{Numbers, RayRows};

/// Where a ray and a triangle meet.
#[derive(Debug, Clone, Copy)]
pub struct Meeting {
    /// The triangle's number.
    pub triangle: u32,
    /// In world coordinates.
    pub point: [f64; 3],
}

/// Adds where rays, given by their numbers, hit triangles, whose vertices are `corners`.
pub fn place_meetings(
    corners: Numbers<'_>,
    triangles: &[[u32; 3]],
    rays: &RayRows<'_>,
    hits: &[(usize, Hit)],
    meetings: &mut Vec<Meeting>,
) {
    meetings.extend(hits.iter().map(|(ray, hit)| {
        let vertices = triangles[hit.tri.index()].map(|vertex| corners.triple(3 * vertex as usize));
        Meeting { triangle: hit.tri.0, point: meeting_point(vertices, rays.exact(*ray), hit) }
    }));
}

/// Where a ray and a triangle that it hits meet: on the ray and in the plane, without the rounding to 32 bits; but where
/// the ray is so flat that this is far off, at the hit's weights of the corners.
fn meeting_point([a, b, c]: [[f64; 3]; 3], (origin, direction): ([f64; 3], [f64; 3]), hit: &Hit) -> [f64; 3] {
    let (ab, ac) = (sub(b, a), sub(c, a));
    let normal = [ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]];
    let weighted = [0, 1, 2].map(|k| a[k] + f64::from(hit.u) * ab[k] + f64::from(hit.v) * ac[k]);
    let t = dot(normal, sub(a, origin)) / dot(normal, direction);
    let point = [0, 1, 2].map(|k| origin[k] + t * direction[k]);
    let (off, size) = (sub(point, weighted), dot(ab, ab).max(dot(ac, ac)));
    // NaN is far off, too.
    if dot(off, off) <= 1e-4 * size { point } else { weighted }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
