//! Sierpinski's tetrahedron (Glassner, IEEE CG&A, October 1984; Kay and Kajiya, SIGGRAPH '86): a tetrahedron on four
//! corners of the cube [-1, 1]³, replaced `size` - 1 times by four of half its size at its corners.

use super::{ORIGIN, Primitives, opaque, sized};
use crate::camera::View;
use crate::error::Result;
use crate::generate::place::ball;
use crate::generate::shape::Shape;
use crate::generate::stage::{Prop, Stage, view};
use crate::generate::vector::{Point, add, mul};
use crate::generate::{Generator, within};
use crate::scene::Scene;

sized!(
    /// 4^size triangles.
    Tetra, size = 6
);

const UP: Point = [-0.816497, -0.816497, 0.816497];
/// The cube's corners whose coordinates' product is positive.
const CORNERS: [Point; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

impl Tetra {
    pub(crate) fn primitives(&self) -> Primitives {
        Primitives { triangles: 4_u64.pow(self.size), ..Primitives::default() }
    }
}

impl Generator for Tetra {
    fn check(&self) -> Result<()> {
        within("size", self.size, 1..=15)
    }

    fn triangles_at_most(&self) -> f64 {
        self.primitives().tessellated(1)
    }

    fn views(&self) -> Vec<View> {
        vec![view("given", [1.022846, -3.177154, -2.174512], [-0.004103, -0.004103, 0.216539], UP, 45.0)]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("tetra", UP);
        let red = stage.material(opaque(1.0, 0.0));
        let solid = Shape { positions: CORNERS.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] };
        let prop = stage.prop("tetrahedron", solid, red);
        divide(&mut stage, prop, ORIGIN, 1.0, self.size);
        stage.lights(&[[2.0, -18.0, -5.0]]);
        stage.finish()
    }
}

fn divide(stage: &mut Stage, prop: Prop, centre: Point, half: f64, depth: u32) {
    if depth == 1 {
        return stage.place(prop, ball(centre, half));
    }
    for corner in CORNERS {
        divide(stage, prop, add(centre, mul(corner, half / 2.0)), half / 2.0, depth - 1);
    }
}
