//! A cubic lattice of mirroring spheres joined by matte cylinders (Antonio Costa): the unit cube, spheres of radius
//! 1/(4·size), cylinders of radius 1/(16·size) that end just inside of the spheres.

use super::{Primitives, RESOLUTION, Y_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::{ball, between};
use crate::generate::stage::{Stage, view};
use crate::generate::{Generator, round, within};
use crate::scene::Scene;

sized!(
    /// (size+1)³ spheres and 3·size·(size+1)² cylinders.
    Lattice, size = 12, resolution = RESOLUTION
);

impl Lattice {
    pub(crate) fn primitives(&self) -> Primitives {
        let n = u64::from(self.size);
        Primitives { spheres: (n + 1).pow(3), tubes: 3 * n * (n + 1).pow(2), ..Primitives::default() }
    }

    /// From the front face, between two layers, along a plane of the lattice.
    fn given(&self) -> View {
        let n = f64::from(self.size);
        let x = (f64::from(self.size / 2) + 0.5) / n;
        view("given", [x, 1.0, 1.0 - 0.5 / n], [x, -1.0, -1.0 - 0.5 / n], [0.2, 1.0, 0.0], 60.0)
    }
}

impl Generator for Lattice {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=200)?;
        within("resolution", self.resolution, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        vec![self.given()]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("lattice", Y_UP);
        let shiny = stage.material(opaque(0.5, 0.5));
        let matte = stage.material(opaque(0.99, 0.0));
        let sphere = stage.prop("sphere", round::sphere(self.resolution), shiny);
        let tube = stage.prop("cylinder", round::tube(self.resolution, 1.0), matte);
        let n = f64::from(self.size);
        let (large, small) = (0.25 / n, 0.0625 / n);
        let inset = large * (1.0 - (small / large).sqrt()) * 0.99;
        for i in 0..(self.size + 1).pow(3) {
            let cell = [i / (self.size + 1).pow(2), i / (self.size + 1) % (self.size + 1), i % (self.size + 1)];
            let corner = cell.map(|c| f64::from(c) / n);
            stage.place(sphere, ball(corner, large));
            for axis in (0..3).filter(|&a| cell[a] < self.size) {
                let along = |by: f64| std::array::from_fn(|a| corner[a] + if a == axis { by } else { 0.0 });
                stage.place(tube, between(along(inset), along(1.0 / n - inset), small));
            }
        }
        stage.lights(&[
            [2.0, 0.5, 0.5],
            [-1.0, 0.5, 0.5],
            [0.5, 2.0, 0.5],
            [0.5, -1.0, 0.5],
            [0.5, 0.5, 2.0],
            [0.5, 0.5, -1.0],
        ]);
        stage.finish()
    }
}
