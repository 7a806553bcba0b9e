//! A height field, y = 3 cos(2πρ) e^(-ρ) with ρ the distance from the y axis, over [-4, 4]² (Alexander Enzmann).
//!
//! The package samples at multiples of 8/n and draws at multiples of 8/(n - 1); here the samples are taken where they
//! are drawn. Its default size, 1, has 1,922 triangles; ours is 4.

use super::{ORIGIN, Primitives, Z_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::stage::{Stage, view};
use crate::generate::{Generator, round, within};
use crate::scene::Scene;

sized!(
    /// n² samples with n = 32·2^(size-1): 2 (n - 1)² triangles.
    Sombrero, size = 4
);

impl Sombrero {
    fn cells(&self) -> u32 {
        (32 << (self.size - 1)) - 1
    }

    pub(crate) fn primitives(&self) -> Primitives {
        Primitives { triangles: 2 * u64::from(self.cells()).pow(2), ..Primitives::default() }
    }
}

impl Generator for Sombrero {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=12)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(1)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [0.0, 5.0, -8.0], ORIGIN, Z_UP, 40.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("sombrero", Z_UP);
        let red = stage.material(opaque(0.8, 0.0));
        let height = |z: f64, x: f64| {
            let rho = (x * x + z * z).sqrt();
            [x, 3.0 * (std::f64::consts::TAU * rho).cos() * (-rho).exp(), z]
        };
        // z before x: the outside is above, and z × x = y.
        let field = round::sheet(self.cells(), self.cells(), |u, v| height(8.0 * u - 4.0, 8.0 * v - 4.0));
        stage.add("sombrero", field, red);
        stage.lights(&[[10.0, 10.0, -10.0]]);
        stage.finish()
    }
}
