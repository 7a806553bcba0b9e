//! A tree after Aono and Kunii (IEEE CG&A, May 1984): each branch, a cone with a sphere on its top, forks in two.
//!
//! The forks lean by 40° and 25°, at 90° and 230° about the branch, are 0.65 and 0.70 as long and 0.67 as thick; the
//! trunk is 1 long and 0.15 in radius at its foot, and every branch narrows to 0.67. It stands on a field of ±50.

use super::{Primitives, RESOLUTION, Z_UP, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::{ball, between, stretch, turn};
use crate::generate::shape::ground;
use crate::generate::stage::{Prop, Stage, view};
use crate::generate::{Generator, round, within};
use crate::scene::{Scene, Transform};

sized!(
    /// 2^(size+1) - 1 cones and as many spheres, and a square.
    Tree, size = 11, resolution = RESOLUTION
);

const NARROWING: f64 = 0.67;

impl Tree {
    pub(crate) fn primitives(&self) -> Primitives {
        let branches = (2_u64 << self.size) - 1;
        Primitives { spheres: branches, tubes: branches, quads: 1, ..Primitives::default() }
    }
}

impl Generator for Tree {
    fn check(&self) -> Result<()> {
        within("size", self.size, 0..=22)?;
        within("resolution", self.resolution, 1..=64)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(self.resolution)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [4.5, 0.4, 2.0], [0.0, 0.0, 1.5], Z_UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("tree", Z_UP);
        let grass = stage.material(opaque(1.0, 0.0));
        stage.add("field", ground([-50.0; 2], [50.0; 2], 0.0), grass);
        let bark = stage.material(opaque(1.0, 0.0));
        let parts = Parts {
            sphere: stage.prop("sphere", round::sphere(self.resolution), bark),
            cone: stage.prop("cone", round::tube(self.resolution, NARROWING), bark),
            forks: [fork(40.0, 90.0, 0.65), fork(25.0, 230.0, 0.70)],
        };
        parts.grow(&mut stage, &Transform::IDENTITY, 0.15, self.size);
        stage.lights(&[
            [-5.0, 5.0, 50.0],
            [30.0, -30.0, 30.0],
            [-40.0, -30.0, 20.0],
            [10.0, 30.0, 40.0],
            [-30.0, 40.0, 10.0],
            [50.0, 25.0, 20.0],
            [-10.0, -60.0, 30.0],
        ]);
        stage.finish()
    }
}

/// From a branch's own space to its parent's: lean, turn, shrink, and move to the parent's top.
fn fork(lean: f64, around: f64, contraction: f64) -> Transform {
    let turned = turn(Z_UP, around).after(&turn([1.0, 0.0, 0.0], lean));
    Transform::translation(Z_UP).after(&stretch([contraction; 3])).after(&turned)
}

struct Parts {
    sphere: Prop,
    cone: Prop,
    forks: [Transform; 2],
}

impl Parts {
    fn grow(&self, stage: &mut Stage, branch: &Transform, radius: f64, depth: u32) {
        let (foot, top) = (branch.point([0.0; 3]), branch.point(Z_UP));
        stage.place(self.cone, between(foot, top, radius));
        stage.place(self.sphere, ball(top, radius * NARROWING));
        if depth > 0 {
            for fork in &self.forks {
                self.grow(stage, &branch.after(fork), radius * NARROWING, depth - 1);
            }
        }
    }
}
