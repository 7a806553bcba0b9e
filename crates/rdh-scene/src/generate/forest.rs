//! A forest: trees grown from seeds, bushes, stones and grass on rolling ground, and a trail through it along x.
//!
//! Six trees (four broad-leaved, two slender) are grown once and stand many times, turned and scaled. They stand one in
//! each cell of a jittered grid of 4 m, so that any number of them is as dense; the trail is kept free.

use super::noise::{Dice, value_noise};
use super::place::{ball, stand, stretch};
use super::props::{Habit, bush, grass, tree};
use super::round::{sheet, sphere};
use super::shape::Shape;
use super::stage::{Paint, Prop, Stage, view};
use super::vector::{Point, mul};
use super::{Generator, within};
use crate::camera::View;
use crate::error::Result;
use crate::path::CameraPath;
use crate::scene::{Material, Scene};

/// The parameters of a forest.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Forest {
    /// How many trees.
    pub(crate) trees: u32,
    /// How far branches fork, and how finely they are cut.
    pub(crate) detail: u32,
    /// Which forest.
    pub(crate) seed: u32,
}

impl Default for Forest {
    fn default() -> Self {
        Self { trees: 200, detail: 2, seed: 1 }
    }
}

const UP: Point = [0.0, 0.0, 1.0];
/// From tree to tree.
const SPACING: f64 = 4.0;
/// Half the trail's width.
const TRAIL: f64 = 1.3;
const TREES: usize = 6;
const TUFTS_A_CELL: usize = 12;

impl Forest {
    /// Cells along a side.
    fn cells(&self) -> u32 {
        (1..).find(|n| n * n >= self.trees).unwrap_or(1)
    }

    fn half(&self) -> f64 {
        0.5 * SPACING * f64::from(self.cells())
    }

    fn dice(&self, keys: &[i64]) -> Dice {
        Dice::new(u64::from(self.seed), keys)
    }

    fn height(&self, x: f64, y: f64) -> f64 {
        let seed = u64::from(self.seed) ^ 0xf0_0d;
        1.6 * value_noise(seed, x / 17.0, y / 17.0) + 0.3 * value_noise(seed + 1, x / 4.3, y / 4.3)
    }

    /// A point at some height above the ground.
    fn above(&self, x: f64, y: f64, by: f64) -> Point {
        [x, y, self.height(x, y) + by]
    }

    /// The habit of a tree: the last two are slender.
    fn habit(&self, which: usize, dice: &mut Dice) -> Habit {
        let slender = which + 2 >= TREES;
        Habit {
            trunk: dice.between(1.8, 2.8) * if slender { 1.5 } else { 1.0 },
            radius: dice.between(0.14, 0.24),
            depth: 3 + self.detail,
            branches: 3,
            spread: if slender { 0.45 } else { dice.between(0.65, 0.95) },
            leaves: 4 + 4 * self.detail,
            leaf: 0.32 / f64::from(self.detail).sqrt(),
            resolution: 1 + self.detail,
        }
    }

    fn grow(&self, stage: &mut Stage, which: usize, bark: Paint, green: Paint) -> [Prop; 2] {
        let mut dice = self.dice(&[1, which as i64]);
        let habit = self.habit(which, &mut dice);
        let (wood, leaves) = tree(&habit, &mut dice);
        [stage.prop("wood", wood, bark), stage.prop("leaves", leaves, green)]
    }

    /// Triangles of a tree, all of which have the same number.
    fn tree_triangles(&self) -> f64 {
        let (depth, r) = (3 + self.detail, 1 + self.detail);
        let branches = |depth: u32| (f64::from(3_u32.pow(depth + 1)) - 1.0) / 2.0;
        let twigs = f64::from(3_u32.pow(depth));
        branches(depth) * 8.0 * f64::from(r) + twigs * f64::from(4 + 4 * self.detail) * 2.0
    }

    fn place_trees(&self, stage: &mut Stage, kinds: &[[Prop; 2]]) {
        for tree in 0..self.trees {
            let mut dice = self.dice(&[2, tree.into()]);
            let [x, y] = self.somewhere(tree, &mut dice, 0.35);
            let kind = kinds[dice.below(kinds.len())];
            let size = dice.between(0.75, 1.25);
            let at = stand(self.above(x, y, 0.0), dice.between(0.0, 360.0)).after(&stretch([size; 3]));
            kind.into_iter().for_each(|prop| stage.place(prop, at));
        }
    }

    /// A place in a cell, away from its sides, and off the trail.
    fn somewhere(&self, cell: u32, dice: &mut Dice, margin: f64) -> [f64; 2] {
        let within =
            |i: u32, dice: &mut Dice| (f64::from(i) + dice.between(margin, 1.0 - margin)) * SPACING - self.half();
        let x = within(cell % self.cells(), dice);
        let y = within(cell / self.cells(), dice);
        let off_trail = if y.abs() >= TRAIL { y } else { TRAIL.copysign(y) + y };
        [x, off_trail]
    }

    /// Bushes, stones and grass, cell by cell.
    fn place_undergrowth(&self, stage: &mut Stage, green: Paint, stone: Paint) {
        let d = self.detail;
        let bushes = [0, 1, 2].map(|i| stage.prop("bush", bush(0.7, 120 * d, &mut self.dice(&[3, i])), green));
        let tufts = [0, 1, 2, 3].map(|i| stage.prop("grass", grass(0.35, 20 * d, &mut self.dice(&[4, i])), green));
        let stones = [0, 1].map(|i| stage.prop("stone", boulder(1 + 2 * d, &mut self.dice(&[5, i])), stone));
        for cell in 0..self.cells().pow(2) {
            let mut dice = self.dice(&[6, cell.into()]);
            for _ in 0..TUFTS_A_CELL {
                let [x, y] = self.somewhere(cell, &mut dice, 0.0);
                let (tuft, turned) = (tufts[dice.below(tufts.len())], dice.between(0.0, 360.0));
                stage.place(tuft, stand(self.above(x, y, 0.0), turned));
            }
            let [x, y] = self.somewhere(cell, &mut dice, 0.1);
            let (turned, size) = (dice.between(0.0, 360.0), dice.between(0.5, 1.1));
            let at = stand(self.above(x, y, 0.0), turned).after(&stretch([size; 3]));
            match dice.below(5) {
                0 | 1 => stage.place(bushes[dice.below(bushes.len())], at),
                2 => stage.place(stones[dice.below(stones.len())], at),
                _ => {}
            }
        }
    }
}

/// A stone: a sphere pushed in and out, half in the ground.
fn boulder(resolution: u32, dice: &mut Dice) -> Shape {
    let mut shape = sphere(resolution);
    let seed = (dice.unit() * 1e9) as u64;
    for p in &mut shape.positions {
        let bump = value_noise(seed, 1.7 * p[0] + 3.1 * p[2], 1.7 * p[1] - 2.3 * p[2]);
        *p = mul(*p, 1.0 + 0.25 * bump);
    }
    Shape::default().with(&shape, &ball([0.0, 0.0, 0.1], 0.4).after(&stretch([1.3, 1.0, 0.8])))
}

impl Generator for Forest {
    fn check(&self) -> Result<()> {
        within("trees", self.trees, 1..=1_000_000)?;
        within("detail", self.detail, 1..=4)
    }

    fn triangles_at_most(&self) -> f64 {
        let detail = f64::from(self.detail);
        let cells = f64::from(self.cells()).powi(2);
        let undergrowth = 240.0 * detail + 8.0 * (1.0 + 2.0 * detail).powi(2) + TUFTS_A_CELL as f64 * 60.0 * detail;
        f64::from(self.trees) * self.tree_triangles() + cells * (undergrowth + 32.0) + 1_000.0
    }

    fn views(&self) -> Vec<View> {
        let half = self.half();
        vec![
            view("trail", self.above(-0.9 * half, 0.0, 1.6), self.above(0.0, 0.0, 2.0), UP, 65.0),
            view("ground", self.above(-0.3 * half, 0.4, 0.35), self.above(0.2 * half, -3.0, 0.8), UP, 60.0),
            view("crowns", self.above(0.05 * half, 0.0, 1.2), self.above(0.4 * half, 0.4 * half, 8.0), UP, 70.0),
            view("above", [-1.5 * half, -1.5 * half, 1.1 * half + 8.0], [0.0, 0.0, 2.0], UP, 45.0),
        ]
    }

    fn paths(&self) -> Vec<CameraPath> {
        let at = |t: f64| self.above((2.0 * t - 1.0) * 0.9 * self.half(), 0.0, 1.6);
        let views =
            (0..8).map(|i| view("walk", at(f64::from(i) / 8.0), at(f64::from(i + 1) / 8.0), UP, 65.0)).collect();
        vec![CameraPath { name: "walk".to_owned(), views, frames: 120 }]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("forest", UP);
        let mut matte = |diffuse: f32| stage.material(Material { diffuse, ..Material::DIFFUSE });
        let (soil, bark, green, stone) = (matte(0.4), matte(0.3), matte(0.5), matte(0.6));
        let half = self.half() + SPACING;
        let cells = 4 * (self.cells() + 2);
        let place = |u: f64, v: f64| self.above((2.0 * u - 1.0) * half, (2.0 * v - 1.0) * half, 0.0);
        stage.add("ground", sheet(cells, cells, place), soil);
        let kinds: Vec<[Prop; 2]> = (0..TREES).map(|i| self.grow(&mut stage, i, bark, green)).collect();
        self.place_trees(&mut stage, &kinds);
        self.place_undergrowth(&mut stage, green, stone);
        stage.lights(&[[0.4 * half, -0.7 * half, half + 60.0]]);
        stage.finish()
    }
}
