//! The surface of a body that no single point sees whole: a ball in a ring, joined by two spokes, cut out of a grid by marching
//! tetrahedra. Like scanned models it has triangles of all shapes, down to slivers and points.

use std::collections::BTreeMap;

use rdh::{Mesh, Vec3};

use super::closed::{self, Ball};

/// In the ball, and in the ring opposite the spokes.
pub(super) const INSIDE: [Ball; 2] =
    [Ball { centre: [0.01, -0.02, 0.03], radius: 0.2 }, Ball { centre: [0.03, 0.8, 0.01], radius: 0.06 }];

const BALL: f64 = 0.4;
const RING: f64 = 0.8;
const TUBE: f64 = 0.17;
const SPOKE: f64 = 0.15;

/// How far a point lies outside of the body, by a measure that is 0 on its surface.
fn outside([x, y, z]: [f64; 3]) -> f64 {
    let ball = (x * x + y * y + z * z).sqrt() - BALL;
    let ring = (((x * x + y * y).sqrt() - RING).powi(2) + z * z).sqrt() - TUBE;
    let spokes = ((y * y + z * z).sqrt() - SPOKE).max(x.abs() - RING);
    ball.min(ring).min(spokes)
}

/// The body's surface in a grid of n³ cubes.
pub(super) fn mesh(n: u32) -> Mesh {
    let mut surface = Surface { n, points: Vec::new(), known: BTreeMap::new(), triangles: Vec::new() };
    let cubes = (0..n).flat_map(|x| (0..n).flat_map(move |y| (0..n).map(move |z| [x, y, z])));
    cubes.for_each(|cube| WAYS.iter().for_each(|way| surface.tetrahedron(cube, *way)));
    closed::mesh(surface.points, surface.triangles)
}

/// From one corner of a cube to the opposite one along its edges: the four corners on each way make a tetrahedron (Kuhn 1960).
/// Neighbouring cubes cut their common face alike.
const WAYS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

type Corner = [u32; 3];

struct Surface {
    n: u32,
    points: Vec<Vec3>,
    /// The point on each edge of the grid.
    known: BTreeMap<(Corner, Corner), u32>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    fn tetrahedron(&mut self, cube: Corner, way: [usize; 3]) {
        let mut corners = [cube; 4];
        for (i, axis) in way.into_iter().enumerate() {
            corners[i + 1..].iter_mut().for_each(|corner| corner[axis] += 1);
        }
        let (within, without): (Vec<_>, Vec<_>) = corners.into_iter().partition(|&c| self.outside(c) < 0.0);
        let mut cut = |a: Corner, b: Corner| self.cut(a, b);
        match (&within[..], &without[..]) {
            (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => {
                let triangle = [cut(a, b), cut(a, c), cut(a, d)];
                self.triangles.push(triangle);
            }
            (&[a, b], &[c, d]) => {
                let [p, q, r, s] = [cut(a, c), cut(a, d), cut(b, d), cut(b, c)];
                self.triangles.extend([[p, q, r], [p, r, s]]);
            }
            _ => {}
        }
    }

    fn place(&self, corner: Corner) -> [f64; 3] {
        corner.map(|i| (f64::from(i) / f64::from(self.n) - 0.5) * 2.2)
    }

    fn outside(&self, corner: Corner) -> f64 {
        outside(self.place(corner))
    }

    /// The point of the surface between two corners, one of which lies inside.
    fn cut(&mut self, a: Corner, b: Corner) -> u32 {
        let (a, b) = (a.min(b), a.max(b));
        if let Some(&known) = self.known.get(&(a, b)) {
            return known;
        }
        let (p, q, at_p, at_q) = (self.place(a), self.place(b), self.outside(a), self.outside(b));
        let part = at_p / (at_p - at_q);
        self.points.push([0, 1, 2].map(|axis| (p[axis] + part * (q[axis] - p[axis])) as f32));
        let number = self.points.len() as u32 - 1;
        self.known.insert((a, b), number);
        number
    }
}
