//! Spheres, tubes and turned shapes, tessellated by one parameter.
//!
//! The rule: a quarter of a circle is cut into `resolution` equal parts. A sphere has 8·resolution² triangles (an
//! octahedron at resolution 1), a cylinder or cone without caps has 8·resolution. All vertices lie on the true surface.

use super::place::{ball, between, quarter_exact, stretch};
use super::shape::Shape;
use super::vector::Point;
use crate::scene::Transform;

/// Triangles of a sphere.
pub(crate) fn sphere_triangles(resolution: u32) -> u64 {
    8 * u64::from(resolution).pow(2)
}

/// Triangles of a cylinder or cone, open at both ends.
pub(crate) fn tube_triangles(resolution: u32) -> u64 {
    8 * u64::from(resolution)
}

/// The unit sphere: rings of 4, 8, … 4·resolution, … 4 vertices between the poles.
pub(crate) fn sphere(resolution: u32) -> Shape {
    let mut shape = Shape::default();
    let rings: Vec<(u32, u32)> = (0..=2 * resolution).map(|k| (k.min(2 * resolution - k), k)).collect();
    let mut first = Vec::new();
    for &(quarter, k) in &rings {
        first.push(shape.positions.len() as u32);
        let (r, z) = quarter_exact(90.0 * f64::from(k) / f64::from(resolution));
        for i in 0..(4 * quarter).max(1) {
            let (sin, cos) = quarter_exact(90.0 * f64::from(i) / f64::from(quarter.max(1)));
            shape.vertex([r * cos, r * sin, z]);
        }
    }
    for k in 0..resolution {
        let (small, large) = (ring(first[k as usize], k), ring(first[k as usize + 1], k + 1));
        belt(k, small, large, &mut |t| shape.triangles.push(t));
        let below = (2 * resolution - k) as usize;
        let (small, large) = (ring(first[below], k), ring(first[below - 1], k + 1));
        belt(k, small, large, &mut |[a, b, c]| shape.triangles.push([a, c, b]));
    }
    shape
}

/// The numbers of a ring's vertices, going round.
fn ring(first: u32, quarter: u32) -> impl Fn(u32) -> u32 {
    move |i| first + if quarter == 0 { 0 } else { i % (4 * quarter) }
}

/// The triangles between a ring of 4k vertices and the next larger one below it.
fn belt(k: u32, small: impl Fn(u32) -> u32, large: impl Fn(u32) -> u32, out: &mut impl FnMut([u32; 3])) {
    for quarter in 0..4 {
        let (s, l) = (quarter * k, quarter * (k + 1));
        (0..=k).for_each(|i| out([large(l + i), large(l + i + 1), small(s + i)]));
        (0..k).for_each(|i| out([small(s + i), large(l + i + 1), small(s + i + 1)]));
    }
}

/// A tube from z = 0, where its radius is 1, to z = 1, open at both ends.
pub(crate) fn tube(resolution: u32, top_radius: f64) -> Shape {
    lathe(&[[1.0, 0.0], [top_radius, 1.0]], resolution)
}

/// Turns a profile of (radius, height) about the z axis. The outside lies to the right of the profile's direction:
/// a profile that runs upwards faces outwards. Points of radius 0 become a single vertex.
pub(crate) fn lathe(profile: &[[f64; 2]], resolution: u32) -> Shape {
    let mut shape = Shape::default();
    let sides = 4 * resolution;
    let circle: Vec<(f64, f64)> =
        (0..sides).map(|i| quarter_exact(90.0 * f64::from(i) / f64::from(resolution))).collect();
    let mut below: Option<Vec<u32>> = None;
    for &[r, z] in profile {
        let ring: Vec<u32> = if r == 0.0 {
            vec![shape.vertex([0.0, 0.0, z]); sides as usize]
        } else {
            circle.iter().map(|&(sin, cos)| shape.vertex([r * cos, r * sin, z])).collect()
        };
        if let Some(below) = below {
            for i in 0..sides as usize {
                strip(&mut shape, [below[i], below[(i + 1) % sides as usize], ring[(i + 1) % sides as usize], ring[i]]);
            }
        }
        below = Some(ring);
    }
    shape
}

/// A quadrilateral of which one side may have shrunk to a point.
fn strip(shape: &mut Shape, [a, b, c, d]: [u32; 4]) {
    if a != b {
        shape.triangles.push([a, b, c]);
    }
    if c != d {
        shape.triangles.push([a, c, d]);
    }
}

/// A solid cylinder from z = 0 to z = height.
pub(crate) fn drum(radius: f64, height: f64, resolution: u32) -> Shape {
    lathe(&[[0.0, 0.0], [radius, 0.0], [radius, height], [0.0, height]], resolution)
}

/// A closed ring: a circle of radius `minor` carried round one of radius `major` in the plane z = 0.
pub(crate) fn torus(major: f64, minor: f64, resolution: u32) -> Shape {
    let (around, across) = (4 * resolution, 2 * resolution.max(2));
    let mut shape = Shape::default();
    for i in 0..around {
        let (sin, cos) = quarter_exact(360.0 * f64::from(i) / f64::from(around));
        for j in 0..across {
            let (s, c) = quarter_exact(360.0 * f64::from(j) / f64::from(across));
            let r = major + minor * c;
            shape.vertex([r * cos, r * sin, minor * s]);
        }
    }
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    for i in 0..around {
        for j in 0..across {
            shape.quad_of([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    shape
}

/// A grid of vertices over [0, 1]², `columns` by `rows` cells of two triangles, at the points that `place(u, v)` says.
/// Its outside is where u and v turn counterclockwise.
pub(crate) fn sheet(columns: u32, rows: u32, place: impl Fn(f64, f64) -> Point) -> Shape {
    let mut shape = Shape::default();
    for j in 0..=rows {
        for i in 0..=columns {
            shape.vertex(place(f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows)));
        }
    }
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    for j in 0..rows {
        for i in 0..columns {
            shape.quad_of([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    shape
}

impl Shape {
    /// Adds a closed rod from one point to another.
    pub(crate) fn rod(&mut self, from: Point, to: Point, radius: f64, resolution: u32) {
        self.append(&drum(1.0, 1.0, resolution), &between(from, to, radius));
    }

    /// Adds a turned profile that stands upright at a place.
    pub(crate) fn turned(&mut self, profile: &[[f64; 2]], at: Point, resolution: u32) {
        self.append(&lathe(profile, resolution), &Transform::translation(at));
    }

    /// Adds a ball.
    pub(crate) fn ball(&mut self, centre: Point, radius: f64, resolution: u32) {
        self.append(&sphere(resolution), &ball(centre, radius));
    }

    /// Adds a box with round edges: a sphere pushed towards its corners.
    pub(crate) fn pillow(&mut self, min: Point, max: Point, resolution: u32) {
        let mut soft = sphere(resolution);
        for p in &mut soft.positions {
            let largest = p.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            // Between the sphere (0) and the cube (1).
            *p = super::vector::lerp(*p, p.map(|x| x / largest), 0.62);
        }
        let half = [0, 1, 2].map(|a| (max[a] - min[a]) / 2.0);
        let reach = soft.positions.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let middle = [0, 1, 2].map(|a| (max[a] + min[a]) / 2.0);
        self.append(&soft, &Transform::translation(middle).after(&stretch(half.map(|x| x / reach))));
    }
}
