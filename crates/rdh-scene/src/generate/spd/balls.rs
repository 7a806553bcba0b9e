//! The sphereflake: a sphere of radius 0.5 bears nine spheres of a third of its radius, and so on.
//!
//! The nine directions are a trio of unit vectors, (1, 1, 0), (1, 0, -1) and (0, 1, -1) over √2, tilted about
//! (1, -1, 0) by asin(2/√6), three times about z; each child's frame has its z along the way out from its parent.

use super::{ORIGIN, Primitives, RESOLUTION, Z_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::{ball, turn};
use crate::generate::shape::ground;
use crate::generate::stage::{Prop, Stage, view};
use crate::generate::vector::{Point, add, cross, mul, unit};
use crate::generate::{Generator, round, within};
use crate::scene::{Scene, Transform};

sized!(
    /// Σ 9ⁿ spheres, n = 0..=size, on a square.
    Balls, size = 4, resolution = RESOLUTION
);

impl Balls {
    pub(crate) fn primitives(&self) -> Primitives {
        Primitives { spheres: (0..=self.size).map(|n| 9_u64.pow(n)).sum(), quads: 1, ..Primitives::default() }
    }
}

impl Generator for Balls {
    fn check(&self) -> Result<()> {
        within("size", self.size, 0..=9)?;
        within("resolution", self.resolution, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [2.1, 1.3, 1.7], ORIGIN, Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("balls", Z_UP);
        let floor = stage.material(opaque(0.8, 0.0));
        stage.add("floor", ground([-12.0; 2], [12.0; 2], -0.5), floor);
        let shiny = stage.material(opaque(0.5, 0.5));
        let sphere = stage.prop("sphere", round::sphere(self.resolution), shiny);
        bloom(&mut stage, sphere, self.size, ORIGIN, 0.5, Z_UP);
        stage.lights(&[[4.0, 3.0, 2.0], [1.0, -4.0, 4.0], [-3.0, 1.0, 5.0]]);
        stage.finish()
    }
}

/// The nine directions about +z.
fn petals() -> [Point; 9] {
    let s = 0.5_f64.sqrt();
    let tilt = turn(unit([1.0, -1.0, 0.0]), (2.0 / 6.0_f64.sqrt()).asin().to_degrees());
    let trio = [[s, s, 0.0], [s, 0.0, -s], [0.0, s, -s]].map(|p| tilt.point(p));
    std::array::from_fn(|i| turn(Z_UP, 120.0 * (i / 3) as f64).point(trio[i % 3]))
}

/// Turns +z to a direction, the short way.
fn frame(direction: Point) -> Transform {
    // The margins keep rounding from picking an arbitrary axis.
    if direction[2] >= 0.9999 {
        Transform::IDENTITY
    } else if direction[2] <= -0.9999 {
        turn([0.0, 1.0, 0.0], 180.0)
    } else {
        turn(unit(cross(Z_UP, direction)), direction[2].acos().to_degrees())
    }
}

fn bloom(stage: &mut Stage, sphere: Prop, depth: u32, centre: Point, radius: f64, outward: Point) {
    stage.place(sphere, ball(centre, radius));
    if depth == 0 {
        return;
    }
    let frame = frame(outward);
    for petal in petals() {
        let direction = frame.point(petal);
        // Parent and child touch.
        let child = add(centre, mul(direction, radius * (4.0 / 3.0)));
        bloom(stage, sphere, depth - 1, child, radius / 3.0, direction);
    }
}
