//! A pyramid of knots of six interlocked pentagonal rings, seen from its point, before a wall.
//!
//! A knot: the pentagon of circumradius 1/(1 + r) in the plane z = 0 and its five images on the planes of a dodecahedron's
//! other directions; each edge is a cylinder, each corner a sphere, of radius r = 0.07412. Layer d (from 0) has (d+1)²
//! knots at y = (d+1)/sin(π/8), spaced by 2 in x and z, so that the pyramid just fills 45°.

use super::{Primitives, RESOLUTION, Z_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::{ball, between, turn};
use crate::generate::shape::Shape;
use crate::generate::stage::{Prop, Stage, view};
use crate::generate::vector::{Point, add};
use crate::generate::{Generator, round, within};
use crate::scene::Scene;

sized!(
    /// 5·size·(size+1)·(2·size+1) spheres and as many cylinders, and a square.
    Rings, size = 7, resolution = RESOLUTION
);

const RADIUS: f64 = 0.07412;

/// From layer to layer, so that neighbours in a layer touch the sides of a 45° view.
fn spread() -> f64 {
    1.0 / (std::f64::consts::PI / 8.0).sin()
}

fn eye() -> Point {
    [-1.0, -spread(), 0.5]
}

impl Rings {
    pub(crate) fn primitives(&self) -> Primitives {
        let n = u64::from(self.size);
        let each = 5 * n * (n + 1) * (2 * n + 1);
        Primitives { spheres: each, tubes: each, quads: 1, ..Primitives::default() }
    }
}

impl Generator for Rings {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=200)?;
        within("resolution", self.resolution, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        let eye = eye();
        vec![view("given", eye, add(eye, [0.0, 1.0, 0.0]), Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("rings", Z_UP);
        let spread = spread();
        let white = stage.material(opaque(1.0, 0.0));
        stage.add("wall", wall(eye(), spread * f64::from(self.size + 1)), white);
        let paint = stage.material(opaque(0.5, 0.2));
        let sphere = stage.prop("sphere", round::sphere(self.resolution), paint);
        let tube = stage.prop("cylinder", round::tube(self.resolution, 1.0), paint);
        let corners = corners();
        for depth in 0..self.size {
            for (row, column) in (0..=depth).flat_map(|z| (0..=depth).map(move |x| (z, x))) {
                let across = |i: u32| f64::from(2 * i) - f64::from(depth);
                let centre = [across(column), spread * f64::from(depth + 1), across(row)];
                knot(&mut stage, sphere, tube, &corners.map(|c| add(c, centre)));
            }
        }
        stage.lights(&[[3.0, -spread, 3.0], [-4.0, -spread, 1.0], [2.0, -spread, -4.0]]);
        stage.finish()
    }
}

/// The back wall, 1 % larger than the view.
fn wall(eye: Point, y: f64) -> Shape {
    let half = 1.01 * (y - eye[1]) * (std::f64::consts::PI / 8.0).tan();
    let corner = |x: f64, z: f64| [eye[0] + x * half, y, eye[2] + z * half];
    let mut shape = Shape::default();
    shape.quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    shape
}

/// The thirty corners, pentagon by pentagon.
fn corners() -> [Point; 30] {
    let flat: [Point; 5] = std::array::from_fn(|i| turn(Z_UP, 72.0 * i as f64).point([1.0 / (1.0 + RADIUS), 0.0, 0.0]));
    let sixty = std::f64::consts::PI / 3.0;
    let thirty_six = std::f64::consts::PI / 5.0;
    let tilt = turn([1.0, 0.0, 0.0], 2.0 * (sixty.cos() / thirty_six.sin()).acos().to_degrees());
    std::array::from_fn(|i| match i / 5 {
        0 => flat[i],
        face => turn(Z_UP, 36.0 * (2 * face - 1) as f64).point(tilt.point(flat[i % 5])),
    })
}

fn knot(stage: &mut Stage, sphere: Prop, tube: Prop, corners: &[Point; 30]) {
    for (i, &corner) in corners.iter().enumerate() {
        let previous = corners[i / 5 * 5 + (i + 4) % 5];
        stage.place(tube, between(corner, previous, RADIUS));
        stage.place(sphere, ball(corner, RADIUS));
    }
}
