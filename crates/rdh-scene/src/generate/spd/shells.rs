//! A sea shell by Pickover's method (IEEE CG&A, November 1989): a spiral of overlapping, growing spheres, meant as
//! a realistic yet pathological scene.
//!
//! Sphere i of N = 180·2^size steps, from -2N/3 to N/3: angle a = 18πi/N, radius r = e^(0.15 a), centre
//! (r sin a, r cos a, -2r).

use super::{Primitives, RESOLUTION, Z_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::ball;
use crate::generate::stage::{Stage, view};
use crate::generate::{Generator, round, within};
use crate::scene::Scene;

sized!(
    /// 180·2^size + 1 spheres.
    Shells, size = 5, resolution = RESOLUTION
);

impl Shells {
    fn steps(&self) -> i64 {
        180 << self.size
    }

    pub(crate) fn primitives(&self) -> Primitives {
        Primitives { spheres: self.steps() as u64 + 1, ..Primitives::default() }
    }
}

impl Generator for Shells {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=20)?;
        within("resolution", self.resolution, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [-6.0, -60.0, 35.0], [0.0, 8.0, -15.0], Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("shells", Z_UP);
        let paint = stage.material(opaque(0.8, 0.2));
        let sphere = stage.prop("sphere", round::sphere(self.resolution), paint);
        let steps = self.steps();
        for i in -steps * 2 / 3..=steps / 3 {
            let angle = 18.0 * std::f64::consts::PI * i as f64 / steps as f64;
            let r = (0.15 * angle).exp();
            stage.place(sphere, ball([r * angle.sin(), r * angle.cos(), -2.0 * r], r));
        }
        stage.lights(&[[-100.0, -100.0, 100.0]]);
        stage.finish()
    }
}
