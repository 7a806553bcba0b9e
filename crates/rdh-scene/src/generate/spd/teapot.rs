//! Newell's teapot, 32 bicubic patches, on a checkerboard of ±4.
//!
//! The patches' control points follow from a few numbers: rim, body, lid and bottom are turned profiles, a quarter circle
//! having the control points (1, 0), (1, 0.56), (0.56, 1), (0, 1); handle and spout are rows of two points in the plane
//! y = 0 and a half width. Each patch is cut into size² cells of two triangles; those with two corners on the axis
//! (at the lid's knob and the bottom's middle) are left out. The checkerboard has size² squares.
//! The patches don't meet exactly where handle and spout enter the body, as with the original.

use super::{ORIGIN, Primitives, Z_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::shape::Shape;
use crate::generate::stage::{Stage, view};
use crate::generate::vector::{Point, add, mul};
use crate::generate::{Generator, within};
use crate::scene::Scene;

sized!(
    /// 64·size² - 8·size triangles and size² squares.
    Teapot, size = 12
);

/// Profiles of four control points (radius, height), each with its outside to the left of its direction.
const PROFILES: [[[f64; 2]; 4]; 6] = [
    // Rim, from its inside to its outside.
    [[1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4]],
    // Body.
    [[1.5, 2.4], [1.75, 1.875], [2.0, 1.35], [2.0, 0.9]],
    [[2.0, 0.9], [2.0, 0.45], [1.5, 0.225], [1.5, 0.15]],
    // Lid.
    [[0.0, 3.15], [0.8, 3.15], [0.0, 2.85], [0.2, 2.7]],
    [[0.2, 2.7], [0.4, 2.55], [1.3, 2.55], [1.3, 2.4]],
    // Bottom, from its edge to its middle.
    [[1.5, 0.15], [1.5, 0.075], [1.425, 0.0], [0.0, 0.0]],
];

/// A row of handle or spout: two points (x, z) and the half width between them.
type Row = ([f64; 2], [f64; 2], f64);

const HANDLE_ROWS: [[Row; 4]; 2] = [
    [
        ([-1.6, 2.025], [-1.5, 2.25], 0.3),
        ([-2.3, 2.025], [-2.5, 2.25], 0.3),
        ([-2.7, 2.025], [-3.0, 2.25], 0.3),
        ([-2.7, 1.8], [-3.0, 1.8], 0.3),
    ],
    [
        ([-2.7, 1.8], [-3.0, 1.8], 0.3),
        ([-2.7, 1.575], [-3.0, 1.35], 0.3),
        ([-2.5, 1.125], [-2.65, 0.9375], 0.3),
        ([-2.0, 0.9], [-1.9, 0.6], 0.3),
    ],
];

const SPOUT_ROWS: [[Row; 4]; 2] = [
    [
        ([1.7, 1.425], [1.7, 0.6], 0.66),
        ([2.6, 1.425], [3.1, 0.825], 0.66),
        ([2.3, 2.1], [2.4, 2.025], 0.25),
        ([2.7, 2.4], [3.3, 2.4], 0.25),
    ],
    [
        ([2.7, 2.4], [3.3, 2.4], 0.25),
        ([2.8, 2.475], [3.525, 2.49375], 0.25),
        ([2.9, 2.475], [3.45, 2.5125], 0.15),
        ([2.8, 2.4], [3.2, 2.4], 0.15),
    ],
];

impl Teapot {
    pub(crate) fn primitives(&self) -> Primitives {
        let n = u64::from(self.size);
        Primitives { triangles: 64 * n * n - 8 * n, quads: n * n, ..Primitives::default() }
    }
}

impl Generator for Teapot {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=1000)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(1)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [4.86, 7.2, 5.4], ORIGIN, Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("teapot", Z_UP);
        let white = stage.material(opaque(0.5, 0.5));
        let grey = stage.material(opaque(0.5, 0.5));
        let enamel = stage.material(opaque(0.75, 0.25));
        stage.add("white squares", squares(self.size, 1), white);
        stage.add("grey squares", squares(self.size, 0), grey);
        stage.add("teapot", teapot(self.size), enamel);
        stage.lights(&[[-3.1, 9.8, 12.1], [11.3, 5.1, 8.8]]);
        stage.finish()
    }
}

/// The checkerboard's squares of one colour.
fn squares(size: u32, odd: u32) -> Shape {
    let place = |i: u32| 8.0 * f64::from(i) / f64::from(size) - 4.0;
    let mut shape = Shape::default();
    for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))).filter(|(i, j)| (i + j) % 2 == odd) {
        let corner = |di: u32, dj: u32| [place(i + di), place(j + dj), 0.0];
        shape.quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
    }
    shape
}

fn teapot(size: u32) -> Shape {
    let mut shape = Shape::default();
    for quarter in 0..4 {
        let turned = |[x, y]: [f64; 2]| [[x, y], [-y, x], [-x, -y], [y, -x]][quarter];
        let circle = [[1.0, 0.0], [1.0, 0.56], [0.56, 1.0], [0.0, 1.0]].map(turned);
        for profile in PROFILES {
            patch(&mut shape, size, &profile.map(|[r, z]| circle.map(|[x, y]| [r * x, r * y, z])));
        }
    }
    for rows in HANDLE_ROWS.into_iter().chain(SPOUT_ROWS) {
        // A tube: over one side from the first points to the second, and back over the other.
        let half = |side: f64| {
            rows.map(|([ax, az], [bx, bz], w)| {
                [[ax, 0.0, az], [ax, -w, az], [bx, -w, bz], [bx, 0.0, bz]].map(|[x, y, z]| [x, side * y, z])
            })
        };
        patch(&mut shape, size, &half(1.0).map(|[a, b, c, d]| [d, c, b, a]));
        patch(&mut shape, size, &half(-1.0));
    }
    shape
}

/// Tessellates a patch; its outside is where rows × columns points.
fn patch(shape: &mut Shape, size: u32, control: &[[Point; 4]; 4]) {
    let first = shape.positions.len() as u32;
    for j in 0..=size {
        for i in 0..=size {
            let (row, column) = (bernstein(j, size), bernstein(i, size));
            let sum = |p: Point, r: usize| (0..4).fold(p, |p, c| add(p, mul(control[r][c], row[r] * column[c])));
            shape.vertex((0..4).fold([0.0; 3], sum));
        }
    }
    let at = |j: u32, i: u32| first + j * (size + 1) + i;
    for (j, i) in (0..size).flat_map(|j| (0..size).map(move |i| (j, i))) {
        let [a, b, c, d] = [at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i + 1)];
        for triangle in [[a, b, c], [a, c, d]] {
            let on_axis = triangle.iter().filter(|&&v| is_on_axis(shape.positions[v as usize])).count();
            if on_axis < 2 {
                shape.triangles.push(triangle);
            }
        }
    }
}

fn is_on_axis(p: Point) -> bool {
    p[0].abs() < 1e-9 && p[1].abs() < 1e-9
}

/// The four cubic Bernstein polynomials at i/n; exact at both ends.
fn bernstein(i: u32, n: u32) -> [f64; 4] {
    let t = f64::from(i) / f64::from(n);
    let s = f64::from(n - i) / f64::from(n);
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}
