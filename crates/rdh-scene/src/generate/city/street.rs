//! Streets, pavements, markings, trees, lamps and benches, and the parks.

use super::Paints;
use super::layout::{KERB, LOT, Layout, PAVEMENT, PITCH};
use crate::generate::place::{stand, stretch};
use crate::generate::props::{Habit, bin, bush, tree};
use crate::generate::shape::{Shape, block, ground};
use crate::generate::stage::{Prop, Stage};

/// Half a block, from its middle to the kerb.
const BLOCK: f64 = PITCH / 2.0 - KERB;

/// The ground, the blocks' pavements, lane markings and crossings.
pub(super) fn pave(stage: &mut Stage, layout: &Layout, paints: &Paints) {
    let [x, y] = layout.extent();
    let margin = KERB + 30.0;
    stage.add("asphalt", ground([-margin, -margin], [x + margin, y + margin], 0.0), paints.asphalt);
    let slab = stage.prop("pavement", block([-BLOCK, -BLOCK, -0.1], [BLOCK, BLOCK, PAVEMENT]), paints.stone);
    let lawn = stage.prop("lawn", block([-LOT * 1.8, -LOT * 1.8, 0.0], [LOT * 1.8, LOT * 1.8, 0.05]), paints.green);
    let marks = stage.prop("markings", markings(), paints.white);
    for at in layout.blocks() {
        let [x, y] = layout.centre(at);
        stage.place(slab, stand([x, y, 0.0], 0.0));
        if layout.is_park(at) {
            stage.place(lawn, stand([x, y, PAVEMENT], 0.0));
        }
    }
    // Markings belong to the streets west and south of a block, and to the last ones.
    for (i, j) in (0..=layout.blocks_x).flat_map(|i| (0..=layout.blocks_y).map(move |j| (i, j))) {
        let corner = [PITCH * f64::from(i), PITCH * f64::from(j), 0.0];
        if i < layout.blocks_x {
            stage.place(marks, stand(corner, 0.0));
        }
        if j < layout.blocks_y {
            stage.place(marks, stand(corner, 90.0));
        }
    }
}

/// From one crossing to the next along x: dashes, and a zebra crossing at either end.
fn markings() -> Shape {
    let mut shape = Shape::default();
    let height = 0.01;
    let mut x = KERB + 6.0;
    while x < PITCH - KERB - 6.0 {
        shape.block([x, -0.08, -0.01], [x + 2.0, 0.08, height]);
        x += 4.0;
    }
    for start in [KERB + 0.5, PITCH - KERB - 3.5] {
        for stripe in 0..10 {
            let y = 1.3 * f64::from(stripe) - 6.2;
            shape.block([start, y, -0.01], [start + 3.0, y + 0.65, height]);
        }
    }
    shape
}

/// Places trees, lamps and the rest along the pavements, and fills the parks.
pub(super) fn furnish(stage: &mut Stage, layout: &Layout, paints: &Paints, detail: u32) {
    let kit = Kit::new(stage, layout, paints, detail);
    for at in layout.blocks() {
        let [x, y] = layout.centre(at);
        let mut dice = layout.dice(3, at);
        for side in 0..4 {
            let from_side = stand([x, y, PAVEMENT], 90.0 * f64::from(side));
            let mut put = |prop: Prop, along: f64, from_kerb: f64, degrees: f64| {
                stage.place(prop, from_side.after(&stand([along, from_kerb - BLOCK, 0.0], degrees)));
            };
            for along in [-15.0, -5.0, 5.0, 15.0] {
                if dice.chance(0.75) {
                    let kind = kit.trees[dice.below(kit.trees.len())];
                    let turned = dice.between(0.0, 360.0);
                    kind.into_iter().for_each(|prop| put(prop, along, 0.9, turned));
                }
            }
            for along in [-10.0, 10.0] {
                put(kit.lamp, along, 0.5, 0.0);
            }
            match dice.below(3) {
                0 => put(kit.bench, -1.0, 1.0, 180.0),
                1 => put(kit.shelter, 0.0, 1.6, 180.0),
                _ => put(kit.hydrant, 1.5, 0.6, 0.0),
            }
            put(kit.bin, 3.0, 0.6, 0.0);
            put(kit.signal, BLOCK - 0.7, 0.7, 0.0);
        }
        if layout.is_park(at) {
            park(stage, layout, &kit, at);
        }
    }
}

/// A fountain, trees, bushes and benches.
fn park(stage: &mut Stage, layout: &Layout, kit: &Kit, at: [u32; 2]) {
    let [x, y] = layout.centre(at);
    let z = PAVEMENT + 0.05;
    let mut dice = layout.dice(4, at);
    stage.place(kit.fountain, stand([x, y, z], 0.0));
    for (i, j) in (-3_i32..=3).flat_map(|i| (-3_i32..=3).map(move |j| (i, j))) {
        if i.abs() <= 1 && j.abs() <= 1 {
            continue;
        }
        let [px, py] =
            [x + 5.6 * f64::from(i) + dice.between(-1.5, 1.5), y + 5.6 * f64::from(j) + dice.between(-1.5, 1.5)];
        let place = stand([px, py, z], dice.between(0.0, 360.0));
        match dice.below(4) {
            0 | 1 => kit.trees[dice.below(kit.trees.len())].into_iter().for_each(|prop| {
                stage.place(prop, place.after(&stretch([1.5; 3])));
            }),
            2 => stage.place(kit.bush, place),
            _ => stage.place(kit.bench, place),
        }
    }
}

struct Kit {
    trees: [[Prop; 2]; 3],
    lamp: Prop,
    bench: Prop,
    shelter: Prop,
    hydrant: Prop,
    bin: Prop,
    signal: Prop,
    fountain: Prop,
    bush: Prop,
}

impl Kit {
    fn new(stage: &mut Stage, layout: &Layout, paints: &Paints, detail: u32) -> Self {
        let trees = [0, 1, 2].map(|i| {
            let mut dice = layout.dice(-3, [i, 0]);
            let habit = Habit {
                trunk: 1.9,
                radius: 0.12,
                depth: 2 + detail.min(3),
                branches: 3,
                spread: dice.between(0.6, 0.9),
                leaves: 5 + 2 * detail,
                leaf: 0.34 / f64::from(detail).sqrt(),
                resolution: detail,
            };
            let (wood, leaves) = tree(&habit, &mut dice);
            [stage.prop("wood", wood, paints.bark), stage.prop("leaves", leaves, paints.green)]
        });
        let mut dice = layout.dice(-4, [0, 0]);
        Self {
            trees,
            lamp: stage.prop("street lamp", lamp(detail), paints.metal),
            bench: stage.prop("bench", bench(), paints.bark),
            shelter: stage.prop("shelter", shelter(detail), paints.metal),
            hydrant: stage.prop("hydrant", hydrant(detail), paints.metal),
            bin: stage.prop("bin", scaled(bin(1 + detail), 2.4), paints.metal),
            signal: stage.prop("signal", signal(detail), paints.metal),
            fountain: stage.prop("fountain", fountain(detail), paints.stone),
            bush: stage.prop("bush", bush(0.9, 100 * detail, &mut dice), paints.green),
        }
    }
}

fn scaled(shape: Shape, by: f64) -> Shape {
    Shape::default().with(&shape, &stretch([by; 3]))
}

/// A lamp post whose arm reaches out over the street, towards -y.
fn lamp(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.turned(&[[0.0, 0.0], [0.16, 0.0], [0.14, 0.5], [0.07, 0.6], [0.05, 6.0], [0.0, 6.05]], [0.0; 3], r);
    shape.rod([0.0, 0.0, 5.9], [0.0, -1.6, 6.3], 0.04, r);
    shape.pillow([-0.15, -2.2, 6.2], [0.15, -1.5, 6.4], 1 + r);
    shape
}

/// A bench of slats, its back at +y.
fn bench() -> Shape {
    let mut shape = Shape::default();
    for i in 0..5 {
        let y = 0.1 * f64::from(i) - 0.25;
        shape.block([-0.9, y, 0.43], [0.9, y + 0.07, 0.46]);
    }
    for i in 0..4 {
        let z = 0.5 + 0.11 * f64::from(i);
        shape.block([-0.9, 0.25 + 0.02 * f64::from(i), z], [0.9, 0.28 + 0.02 * f64::from(i), z + 0.08]);
    }
    for x in [-0.8, 0.74] {
        shape.block([x, -0.22, 0.0], [x + 0.06, -0.16, 0.43]);
        shape.block([x, 0.28, 0.0], [x + 0.06, 0.36, 0.9]);
        shape.block([x, -0.16, 0.35], [x + 0.06, 0.28, 0.43]);
    }
    shape
}

/// A bus shelter: roof, back, a side and a seat; its back at +y.
fn shelter(r: u32) -> Shape {
    let mut shape = block([-2.0, -0.7, 2.4], [2.0, 0.8, 2.5]);
    shape.block([-1.9, 0.65, 0.3], [1.9, 0.69, 2.2]);
    shape.block([1.86, -0.4, 0.3], [1.9, 0.6, 2.2]);
    for x in [-1.9, 0.0, 1.9] {
        shape.rod([x, 0.72, 0.0], [x, 0.72, 2.4], 0.04, r);
    }
    shape.block([-1.5, 0.25, 0.42], [1.2, 0.6, 0.46]);
    shape.block([-1.3, 0.4, 0.0], [-1.2, 0.5, 0.42]);
    shape.block([0.9, 0.4, 0.0], [1.0, 0.5, 0.42]);
    shape
}

fn hydrant(r: u32) -> Shape {
    let profile =
        [[0.0, 0.0], [0.14, 0.0], [0.14, 0.05], [0.1, 0.08], [0.1, 0.5], [0.13, 0.53], [0.1, 0.62], [0.0, 0.68]];
    let mut shape = Shape::default();
    shape.turned(&profile, [0.0; 3], 1 + r);
    shape.rod([-0.17, 0.0, 0.4], [0.17, 0.0, 0.4], 0.05, r);
    shape.rod([0.0, -0.18, 0.36], [0.0, 0.0, 0.36], 0.06, r);
    shape
}

/// A traffic light with three lamps under hoods.
fn signal(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.rod([0.0, 0.0, 0.0], [0.0, 0.0, 3.4], 0.06, r);
    shape.block([-0.15, -0.25, 2.4], [0.15, -0.02, 3.35]);
    for i in 0..3 {
        let z = 2.55 + 0.31 * f64::from(i);
        shape.ball([0.0, -0.25, z], 0.1, 1 + r);
        shape.block([-0.13, -0.42, z + 0.11], [0.13, -0.25, z + 0.13]);
    }
    shape
}

/// A basin with a bowl on a stem.
fn fountain(r: u32) -> Shape {
    let basin = [
        [0.0, 0.0],
        [3.6, 0.0],
        [3.6, 0.6],
        [3.3, 0.6],
        [3.3, 0.25],
        [0.5, 0.25],
        [0.3, 1.6],
        [1.4, 2.0],
        [1.5, 2.1],
        [1.3, 2.1],
        [0.2, 1.8],
        [0.12, 2.9],
        [0.0, 3.0],
    ];
    let mut shape = Shape::default();
    shape.turned(&basin, [0.0; 3], 4 * r);
    shape
}
