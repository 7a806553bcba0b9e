//! A cube of meshing gears above a mirroring ground; every fifth, roughly, is of glass.
//!
//! A gear has 36 teeth; its teeth reach 0.995 of its radius (so that neighbours don't touch) from 0.9 of it. Four
//! corners a tooth, at -0.19, 0.19, 0.3 and 0.7 of the tooth's angle.

use super::{ORIGIN, Primitives, Z_UP, opaque, sized, surface};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::stand;
use crate::generate::shape::{Shape, ground};
use crate::generate::stage::{Stage, view};
use crate::generate::{Generator, within};
use crate::scene::Scene;

sized!(
    /// size³ gears of two 144-gons and 144 rectangles each, and a square.
    Gears, size = 4
);

const TEETH: u32 = 36;

impl Gears {
    pub(crate) fn primitives(&self) -> Primitives {
        let gears = u64::from(self.size).pow(3);
        Primitives { gear_faces: 2 * gears, quads: 144 * gears + 1, ..Primitives::default() }
    }
}

impl Generator for Gears {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(1)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [-1.1, -2.1, 2.6], ORIGIN, Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("gears", Z_UP);
        let mirror = stage.material(opaque(0.3, 0.6));
        stage.add("ground", ground([-2.0; 2], [2.0; 2], 0.0), mirror);
        let matte = stage.material(opaque(1.0, 0.0));
        let glass = stage.material(surface(0.2, 0.0, 0.8, 1.1));
        let size = f64::from(self.size);
        let radius = 1.0 / (size - (size - 1.0) * 0.05);
        let shape = gear(radius, (1.0 / (2.0 * size)).min(0.1));
        let props = [stage.prop("gear", shape.clone(), matte), stage.prop("glass gear", shape, glass)];
        for (x, y, z) in cells(self.size) {
            let across = |i: u32| radius - 1.0 + f64::from(i) * radius * 1.9;
            let half_tooth = if (x + y + z) % 2 == 1 { 180.0 / f64::from(TEETH) } else { 0.0 };
            let is_glass = (4 * x + 2 * y + z) % 5 == 0;
            stage.place(
                props[usize::from(is_glass)],
                stand([across(x), across(y), 1.0 - f64::from(z) / size], half_tooth),
            );
        }
        stage.lights(&[
            [2.0, 4.0, 4.0],
            [-2.0, 4.0, 3.0],
            [2.0, -2.5, 2.5],
            [-1.0, -4.0, 2.0],
            [-1.111, -2.121, 2.626],
        ]);
        stage.finish()
    }
}

fn cells(size: u32) -> impl Iterator<Item = (u32, u32, u32)> {
    (0..size).flat_map(move |z| (0..size).flat_map(move |y| (0..size).map(move |x| (x, y, z))))
}

/// A gear whose upper face is at z = 0: closed, 572 triangles.
fn gear(radius: f64, thickness: f64) -> Shape {
    let mut shape = Shape::default();
    let corners = 4 * TEETH;
    for z in [0.0, -thickness] {
        for i in 0..corners {
            let (place, ratio) = [(-0.19, 0.995), (0.19, 0.995), (0.3, 0.9), (0.7, 0.9)][(i % 4) as usize];
            let angle = (f64::from(i / 4) + place) * std::f64::consts::TAU / f64::from(TEETH);
            shape.vertex([radius * ratio * angle.cos(), radius * ratio * angle.sin(), z]);
        }
    }
    for i in 0..corners {
        let next = (i + 1) % corners;
        shape.quad_of([i, corners + i, corners + next, next]);
    }
    let tooth = |t: u32| [(4 * t + corners - 1) % corners, 4 * t, 4 * t + 1, 4 * t + 2];
    let hub: Vec<u32> = (0..corners).filter(|i| i % 4 >= 2).collect();
    (0..TEETH).for_each(|t| shape.quad_of(tooth(t)));
    shape.polygon_of(&hub);
    let below = |i: u32| corners + i;
    for t in 0..TEETH {
        let [a, b, c, d] = tooth(t).map(below);
        shape.quad_of([d, c, b, a]);
    }
    shape.polygon_of(&hub.iter().rev().map(|&i| below(i)).collect::<Vec<_>>());
    shape
}
