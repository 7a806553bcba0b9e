//! A fractal mountain by Carpenter's midpoint displacement, before it a pyramid of four glass spheres.
//!
//! The square [-1, 1]² is halved `size` times; each midpoint is the mean of its neighbours, moved up by a normal deviate
//! times the cell's half side times the roughness of fractal dimension 2.2 (√2 more in a cell's middle). The deviate's
//! seed is 21 plus a hash of the point's place: the package's default, published one, which repeats itself over the
//! mountain. Its shift counts turn negative above size 7, where the package relies on what a compiler makes of that;
//! here, as there in practice, such a term contributes nothing.

use super::{ORIGIN, Primitives, Z_UP, opaque, sized, surface};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::{ball, turn};
use crate::generate::shape::Shape;
use crate::generate::stage::{Prop, Stage, view};
use crate::generate::vector::{add, unit};
use crate::generate::{Generator, round, within};
use crate::scene::Scene;

sized!(
    /// 2·4^size triangles and four spheres.
    Mount, size = 6, resolution = 16
);

impl Mount {
    pub(crate) fn primitives(&self) -> Primitives {
        Primitives { spheres: 4, triangles: 2 * 4_u64.pow(self.size), ..Primitives::default() }
    }
}

impl Generator for Mount {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=15)?;
        within("resolution", self.resolution, 1..=256)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [-1.6, 1.6, 1.7], ORIGIN, Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("mount", Z_UP);
        let rock = stage.material(opaque(1.0, 0.0));
        stage.add("mountain", mountain(self.size), rock);
        let glass = stage.material(surface(0.1, 0.1, 0.9, 1.5));
        let sphere = stage.prop("sphere", round::sphere(self.resolution), glass);
        pyramid(&mut stage, sphere);
        stage.lights(&[[-100.0, -100.0, 100.0]]);
        stage.finish()
    }
}

/// Four touching spheres of radius 0.17 about (-0.8, 0.8, 1).
fn pyramid(stage: &mut Stage, sphere: Prop) {
    let (centre, radius) = ([-0.8, 0.8, 1.0], 0.17);
    let top = [0.0, 0.0, radius * 1.5_f64.sqrt()];
    let foot = turn(unit([1.0, 1.0, 0.0]), (-1.0_f64 / 3.0).acos().to_degrees()).point(top);
    stage.place(sphere, ball(add(centre, top), radius));
    for i in 0..3 {
        let place = turn(Z_UP, 120.0 * f64::from(i)).point(foot);
        stage.place(sphere, ball(add(centre, place), radius));
    }
}

/// The height field, (2^size + 1)² vertices.
fn mountain(size: u32) -> Shape {
    let cells = 1_usize << size;
    let heights = heights(size);
    let mut shape = Shape::default();
    let place = |i: usize| i as f64 * 2.0 / cells as f64 - 1.0;
    for (i, &z) in heights.iter().enumerate() {
        shape.vertex([place(i % (cells + 1)), place(i / (cells + 1)), z]);
    }
    let at = |x: usize, y: usize| (y * (cells + 1) + x) as u32;
    for (y, x) in (0..cells).flat_map(|y| (0..cells).map(move |x| (y, x))) {
        shape.quad_of([at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
    }
    shape
}

/// Heights row by row. Level by level instead of recursively: a midpoint depends on its level's corners only.
fn heights(size: u32) -> Vec<f64> {
    let cells = 1_usize << size;
    let at = |x: usize, y: usize| y * (cells + 1) + x;
    let mut z = vec![0.0; (cells + 1) * (cells + 1)];
    let ratio = 2.0 / (2.0_f64.ln() / 1.2).exp();
    let roughness = (ratio * ratio - 1.0).sqrt();
    let mut width = cells;
    while width > 1 {
        let half = width / 2;
        let rise = half as f64 * 2.0 / cells as f64 * roughness;
        let moved = |mean: f64, x: usize, y: usize, by: f64| mean + by * gauss(21 + hash(x, y, size));
        for y in (0..cells).step_by(width) {
            for x in (0..cells).step_by(width) {
                let [ll, lr] = [z[at(x, y)], z[at(x + width, y)]];
                let [ul, ur] = [z[at(x, y + width)], z[at(x + width, y + width)]];
                z[at(x + half, y)] = moved((ll + lr) / 2.0, x + half, y, rise);
                z[at(x + width, y + half)] = moved((lr + ur) / 2.0, x + width, y + half, rise);
                z[at(x + half, y + width)] = moved((ur + ul) / 2.0, x + half, y + width, rise);
                z[at(x, y + half)] = moved((ul + ll) / 2.0, x, y + half, rise);
                let middle = (ll + lr + ur + ul) / 4.0;
                z[at(x + half, y + half)] = moved(middle, x + half, y + half, std::f64::consts::SQRT_2 * rise);
            }
        }
        width = half;
    }
    z
}

/// The published hash of a point, 16 bits.
fn hash(x: usize, y: usize, size: u32) -> u64 {
    let shifted = |v: usize, by: u32| by.checked_sub(size).map_or(0, |by| (v as u64) << by);
    (shifted(x, 23) + shifted(y, 15) + shifted(x, 7)) & 0xffff
}

/// A normal deviate that depends on a seed only: the polar method with two steps of a linear congruential generator.
fn gauss(seed: u64) -> f64 {
    const MODULUS: u64 = 134_456;
    let step = |i: u64| (28_411 + i * 8_121) % MODULUS;
    let signed = |i: u64| i as f64 * 2.0 / MODULUS as f64 - 1.0;
    let mut state = seed;
    loop {
        let first = step(state);
        state = step(first);
        let (a, b) = (signed(first), signed(state));
        let r = a * a + b * b;
        if r < 1.0 {
            return a * (-2.0 * r.ln() / r).sqrt();
        }
    }
}
