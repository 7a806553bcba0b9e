//! Triangles on their way into a geometry. Seen from outside, corners run counterclockwise.

use super::vector::Point;
use crate::scene::{Geometry, Transform};

/// Vertices and triangles, in f64 until the geometry is made.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<Point>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// As a geometry of the scene.
    pub(crate) fn geometry(self, name: &str, material: usize) -> Geometry {
        let positions = self.positions.iter().map(|p| p.map(|x| x as f32)).collect();
        Geometry { name: name.to_owned(), positions, triangles: self.triangles, material }
    }

    /// Adds a vertex and says its number.
    pub(crate) fn vertex(&mut self, p: Point) -> u32 {
        self.positions.push(p);
        self.positions.len() as u32 - 1
    }

    /// Adds a flat quadrilateral with corners of its own.
    pub(crate) fn quad(&mut self, corners: [Point; 4]) {
        let q = corners.map(|p| self.vertex(p));
        self.quad_of(q);
    }

    /// Adds a quadrilateral of vertices that are there already.
    pub(crate) fn quad_of(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// Adds a convex polygon of vertices that are there already, n - 2 triangles: every second corner is cut off
    /// until nothing is left, which makes fewer slivers than a fan.
    pub(crate) fn polygon_of(&mut self, corners: &[u32]) {
        let mut ring = corners.to_vec();
        while ring.len() > 2 {
            for cut in ring.chunks(2).enumerate().filter(|(_, c)| c.len() == 2).map(|(i, _)| 2 * i) {
                self.triangles.push([ring[cut], ring[cut + 1], ring[(cut + 2) % ring.len()]]);
            }
            ring = ring.into_iter().step_by(2).collect();
        }
    }

    /// Adds an axis-aligned box: 8 vertices, 12 triangles.
    pub(crate) fn block(&mut self, min: Point, max: Point) {
        let corner = |i: usize| [0, 1, 2].map(|a| if i >> a & 1 == 1 { max[a] } else { min[a] });
        let v: Vec<u32> = (0..8).map(|i| self.vertex(corner(i))).collect();
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            self.quad_of(face.map(|i: usize| v[i]));
        }
    }

    /// Adds another shape, transformed by a transform that doesn't mirror.
    pub(crate) fn append(&mut self, other: &Self, transform: &Transform) {
        let base = self.positions.len() as u32;
        self.positions.extend(other.positions.iter().map(|&p| transform.point(p)));
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
    }

    /// The same, chained.
    pub(crate) fn with(mut self, other: &Self, transform: &Transform) -> Self {
        self.append(other, transform);
        self
    }
}

/// A box alone.
pub(crate) fn block(min: Point, max: Point) -> Shape {
    let mut shape = Shape::default();
    shape.block(min, max);
    shape
}

/// A horizontal rectangle that faces up.
pub(crate) fn ground(min: [f64; 2], max: [f64; 2], z: f64) -> Shape {
    let mut shape = Shape::default();
    shape.quad([[min[0], min[1], z], [max[0], min[1], z], [max[0], max[1], z], [min[0], max[1], z]]);
    shape
}
