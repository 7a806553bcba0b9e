//! Jacks within jacks (Alexander Enzmann): three crossed cylinders with a sphere at each end, and eight half-size copies
//! of the whole about it.
//!
//! Cylinders of radius 0.1 from -1 to 1 along each axis, spheres of radius 0.2 at their ends, all scaled by 0.75; the
//! copies are centred at (±0.5, ±0.5, ±0.5); the whole is turned by -20° about y, then by -30° about x.
//! The package's default size, 1, is a single jack; ours is 4.

use super::{ORIGIN, Primitives, RESOLUTION, Y_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::{ball, between, stretch, turn};
use crate::generate::stage::{Prop, Stage, view};
use crate::generate::{Generator, round, within};
use crate::scene::{Scene, Transform};

sized!(
    /// Σ 8ⁿ jacks, n = 0..size, of three cylinders and six spheres each.
    Jacks, size = 4, resolution = RESOLUTION
);

impl Jacks {
    pub(crate) fn primitives(&self) -> Primitives {
        let jacks: u64 = (0..self.size).map(|n| 8_u64.pow(n)).sum();
        Primitives { spheres: 6 * jacks, tubes: 3 * jacks, ..Primitives::default() }
    }
}

impl Generator for Jacks {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=9)?;
        within("resolution", self.resolution, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [0.0, 0.0, -8.0], ORIGIN, Y_UP, 25.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("jacks", Y_UP);
        let pink = stage.material(opaque(0.7, 0.7));
        let parts = Parts {
            sphere: stage.prop("sphere", round::sphere(self.resolution), pink),
            tube: stage.prop("cylinder", round::tube(self.resolution, 1.0), pink),
        };
        let whole = turn([1.0, 0.0, 0.0], -30.0).after(&turn([0.0, 1.0, 0.0], -20.0));
        parts.nest(&mut stage, &whole, self.size);
        stage.lights(&[[-10.0, 3.0, -20.0]]);
        stage.finish()
    }
}

struct Parts {
    sphere: Prop,
    tube: Prop,
}

impl Parts {
    fn nest(&self, stage: &mut Stage, whole: &Transform, depth: u32) {
        self.jack(stage, &whole.after(&stretch([0.75; 3])));
        if depth == 1 {
            return;
        }
        for i in 0..8 {
            let corner = [2, 1, 0].map(|bit| if i >> bit & 1 == 1 { 0.5 } else { -0.5 });
            self.nest(stage, &whole.after(&ball(corner, 0.5)), depth - 1);
        }
    }

    fn jack(&self, stage: &mut Stage, at: &Transform) {
        for axis in 0..3 {
            let end = |x: f64| std::array::from_fn(|a| if a == axis { x } else { 0.0 });
            stage.place(self.tube, at.after(&between(end(-1.0), end(1.0), 0.1)));
            for x in [1.0, -1.0] {
                stage.place(self.sphere, at.after(&ball(end(x), 0.2)));
            }
        }
    }
}
