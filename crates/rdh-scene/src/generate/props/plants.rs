//! Trees, bushes, grass and pot plants, grown by seeded recursion.

use crate::generate::noise::Dice;
use crate::generate::place::axes;
use crate::generate::round::{lathe, tube};
use crate::generate::shape::Shape;
use crate::generate::vector::{Point, add, cross, lerp, mul, unit};

/// How a tree grows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Habit {
    /// Length of the trunk's free part.
    pub(crate) trunk: f64,
    /// Radius at the foot.
    pub(crate) radius: f64,
    /// Forks above each other.
    pub(crate) depth: u32,
    /// Branches of a fork.
    pub(crate) branches: u32,
    /// How far branches lean from their parent, 0 to 1.
    pub(crate) spread: f64,
    /// Leaves of a twig.
    pub(crate) leaves: u32,
    /// A leaf's length.
    pub(crate) leaf: f64,
    /// Parts of a quarter of a branch's round.
    pub(crate) resolution: u32,
}

/// A tree: its wood and its leaves. Branches are tapering tubes; a leaf is two triangles, folded along its middle.
pub(crate) fn tree(habit: &Habit, dice: &mut Dice) -> (Shape, Shape) {
    let mut growth = Growth { habit, wood: Shape::default(), leaves: Shape::default() };
    // The trunk begins below the ground, so that it stands on slopes too.
    growth.branch(dice, [0.0, 0.0, -0.3], [0.0, 0.0, 1.0], habit.trunk + 0.3, habit.radius, habit.depth);
    (growth.wood, growth.leaves)
}

struct Growth<'a> {
    habit: &'a Habit,
    wood: Shape,
    leaves: Shape,
}

impl Growth<'_> {
    fn branch(&mut self, dice: &mut Dice, foot: Point, along: Point, length: f64, radius: f64, depth: u32) {
        // Light pulls upwards, weight down: branches bend a little on their way.
        let top = add(foot, mul(unit(add(along, wobble(dice, 0.12))), length));
        let narrow = if depth == 0 { 0.3 } else { 0.62 };
        let round =
            if depth + 1 >= self.habit.depth { self.habit.resolution } else { self.habit.resolution.div_ceil(2) };
        self.wood.append(&tube(round, narrow), &crate::generate::place::between(foot, top, radius));
        if depth == 0 {
            return self.twig(dice, foot, top);
        }
        let turn = dice.between(0.0, std::f64::consts::TAU);
        for i in 0..self.habit.branches {
            let around = turn + std::f64::consts::TAU * f64::from(i) / f64::from(self.habit.branches);
            let lean = self.habit.spread * dice.between(0.7, 1.3);
            let out = outward(along, around);
            let next = unit(add(add(along, mul(out, lean)), [0.0, 0.0, 0.12]));
            // All but the first leave the branch below its end.
            let start = if i == 0 { top } else { lerp(foot, top, dice.between(0.7, 0.98)) };
            let shorter = length * dice.between(0.62, 0.8);
            self.branch(dice, start, next, shorter, radius * narrow, depth - 1);
        }
    }

    fn twig(&mut self, dice: &mut Dice, foot: Point, top: Point) {
        for i in 0..self.habit.leaves {
            let at = lerp(foot, top, (f64::from(i) + 0.5) / f64::from(self.habit.leaves));
            let along = unit(add(wobble(dice, 1.0), [0.0, 0.0, 0.15]));
            leaf(
                &mut self.leaves,
                at,
                along,
                self.habit.leaf * dice.between(0.7, 1.2),
                dice.between(0.0, std::f64::consts::TAU),
            );
        }
    }
}

/// A vector with coordinates within ±by, never zero.
fn wobble(dice: &mut Dice, by: f64) -> Point {
    [dice.between(-by, by), dice.between(-by, by), dice.between(-by, by) + 1e-6]
}

/// A direction square to another, turned about it.
fn outward(along: Point, around: f64) -> Point {
    let other = if along[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let x = unit(cross(other, along));
    let y = cross(along, x);
    add(mul(x, around.cos()), mul(y, around.sin()))
}

/// A leaf from `at` along a direction: two triangles that share its middle.
fn leaf(shape: &mut Shape, at: Point, along: Point, length: f64, around: f64) {
    let side = outward(along, around);
    let up = cross(along, side);
    let frame = axes(mul(along, length), mul(side, length), mul(up, length), at);
    let corners = [[0.0, 0.0, 0.0], [0.45, -0.28, 0.12], [1.0, 0.0, 0.0], [0.45, 0.28, 0.12]];
    let q = corners.map(|p| shape.vertex(frame.point(p)));
    shape.quad_of(q);
}

/// A bush: leaves over a ball of some radius, more within than without.
pub(crate) fn bush(radius: f64, leaves: u32, dice: &mut Dice) -> Shape {
    let mut shape = Shape::default();
    for _ in 0..leaves {
        let out = unit(wobble(dice, 1.0));
        let at = mul([out[0], out[1], out[2].abs()], radius * dice.unit().cbrt());
        let along = unit(add(out, wobble(dice, 0.8)));
        leaf(&mut shape, at, along, 0.22 * radius, dice.between(0.0, std::f64::consts::TAU));
    }
    shape
}

/// A tuft of grass of some radius: curved blades of three triangles each.
pub(crate) fn grass(radius: f64, blades: u32, dice: &mut Dice) -> Shape {
    let mut shape = Shape::default();
    for _ in 0..blades {
        let (r, around) = (radius * dice.unit().sqrt(), dice.between(0.0, std::f64::consts::TAU));
        let foot = [r * around.cos(), r * around.sin(), -0.03];
        let (height, bend) = (dice.between(0.12, 0.42), dice.between(0.02, 0.2));
        let out = outward([0.0, 0.0, 1.0], dice.between(0.0, std::f64::consts::TAU));
        let side = mul(cross([0.0, 0.0, 1.0], out), 0.008);
        let middle = add(foot, add(mul(out, 0.35 * bend), [0.0, 0.0, 0.6 * height]));
        let tip = add(foot, add(mul(out, bend), [0.0, 0.0, height]));
        let minus = mul(side, -1.0);
        let v =
            [add(foot, side), add(foot, minus), add(middle, minus), add(middle, side), tip].map(|p| shape.vertex(p));
        shape.quad_of([v[0], v[1], v[2], v[3]]);
        shape.triangles.push([v[3], v[2], v[4]]);
    }
    shape
}

/// A pot, and the plant in it: arching leaves as strips of `2·r` parts, within 0.35 m of the middle.
pub(crate) fn plant(leaves: u32, r: u32, dice: &mut Dice) -> (Shape, Shape) {
    let pot =
        [[0.0, 0.0], [0.12, 0.0], [0.17, 0.3], [0.185, 0.3], [0.185, 0.34], [0.16, 0.34], [0.15, 0.3], [0.0, 0.3]];
    let mut green = Shape::default();
    for i in 0..leaves {
        let around = 2.4 * f64::from(i) + dice.between(-0.3, 0.3);
        let (length, droop) = (dice.between(0.5, 1.0), dice.between(0.3, 1.1));
        arch(&mut green, [around.cos(), around.sin(), 0.0], length, droop, 2 * r);
    }
    (lathe(&pot, 2 * r), green)
}

/// A strip that rises from a pot's middle and droops outwards.
fn arch(shape: &mut Shape, out: Point, length: f64, droop: f64, parts: u32) {
    let side = [-out[1], out[0], 0.0];
    let at = |t: f64| add(mul(out, 0.03 + length * 0.28 * t), [0.0, 0.0, 0.3 + length * (1.1 * t - droop * t * t)]);
    let width = |t: f64| 0.07 * length * (t * (1.0 - t)).sqrt() + 0.004;
    let pair = |shape: &mut Shape, t: f64| [-1.0, 1.0].map(|s| shape.vertex(add(at(t), mul(side, s * width(t)))));
    let mut last = pair(shape, 0.0);
    for i in 1..=parts {
        let next = pair(shape, f64::from(i) / f64::from(parts));
        shape.quad_of([last[0], next[0], next[1], last[1]]);
        last = next;
    }
}
