//! Cars: driving ones that a frame moves, waiting ones, and parked ones.

use super::Paints;
use super::layout::{KERB, Layout, PITCH};
use crate::generate::noise::Dice;
use crate::generate::place::stand;
use crate::generate::round::torus;
use crate::generate::shape::{Shape, block};
use crate::generate::stage::Stage;

/// From the street's middle to a lane's.
const LANE: f64 = 1.75;
/// From the street's middle to a parked car's.
const PARKED: f64 = KERB - 1.15;
/// From car to car in a lane, at least a car's length.
const GAP: f64 = 15.0;

/// Places all cars; those that drive along x are where they are at a frame.
pub(super) fn drive(stage: &mut Stage, layout: &Layout, paints: &Paints, detail: u32, frame: u32) {
    let car = |stage: &mut Stage, body: Shape, panes: Shape| {
        let wheels = stage.prop("wheels", wheels(detail), paints.asphalt);
        [stage.prop("car", body, paints.car), stage.prop("panes", panes, paints.pane), wheels]
    };
    let kinds = [car(stage, saloon(detail), saloon_panes(detail)), car(stage, van(detail), van_panes())];
    let mut put = |dice: &mut Dice, x: f64, y: f64, degrees: f64| {
        let kind = kinds[usize::from(dice.chance(0.25))];
        kind.into_iter().for_each(|prop| stage.place(prop, stand([x, y, 0.0], degrees)));
    };
    let [length, _] = layout.extent();
    for street in 0..=layout.blocks_y {
        let y = PITCH * f64::from(street);
        for (lane, forwards) in [(-LANE, true), (LANE, false)] {
            let mut dice = layout.dice(5, [street, u32::from(forwards)]);
            // All cars of a lane are equally fast, so that none runs into another.
            let speed = dice.between(0.5, 0.9);
            let slots = (length / GAP) as u32;
            for slot in 0..slots {
                let start = GAP * f64::from(slot) + dice.between(0.0, 0.5 * GAP);
                let run = (start + speed * f64::from(frame)).rem_euclid(GAP * f64::from(slots));
                if dice.chance(0.7) {
                    let (x, degrees) = if forwards { (run, 0.0) } else { (length - run, 180.0) };
                    put(&mut dice, x, y + lane, degrees);
                }
            }
        }
    }
    for (i, j) in (0..=layout.blocks_x).flat_map(|i| (0..=layout.blocks_y).map(move |j| (i, j))) {
        let mut dice = layout.dice(6, [i, j]);
        let [x, y] = [PITCH * f64::from(i), PITCH * f64::from(j)];
        // Waiting before the crossing, on either side of it.
        for place in 0..3 {
            let away = KERB + 6.5 + 5.5 * f64::from(place);
            if j > 0 && dice.chance(0.6) {
                put(&mut dice, x + LANE, y - away, 90.0);
            }
            if j < layout.blocks_y && dice.chance(0.6) {
                put(&mut dice, x - LANE, y + away, 270.0);
            }
        }
        if i < layout.blocks_x {
            for place in 0..5 {
                let along = x + KERB + 7.0 + 6.8 * f64::from(place);
                for (side, degrees) in [(-PARKED, 0.0), (PARKED, 180.0)] {
                    if dice.chance(0.55) {
                        put(&mut dice, along, y + side, degrees);
                    }
                }
            }
        }
    }
}

/// A car that drives along +x: rounded body, cabin, bumpers, lamps and mirrors.
fn saloon(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.pillow([-2.1, -0.85, 0.3], [2.1, 0.85, 0.95], 2 + 2 * r);
    shape.block([-0.95, -0.62, 1.36], [0.55, 0.62, 1.42]);
    for y in [-0.66, 0.66] {
        shape.rod([-1.4, y * 1.1, 0.85], [-0.9, y * 0.95, 1.39], 0.04, r);
        shape.rod([1.2, y * 1.1, 0.85], [0.5, y * 0.95, 1.39], 0.04, r);
        shape.rod([-0.1, y * 1.12, 0.88], [-0.1, y * 0.95, 1.39], 0.03, r);
        shape.pillow([0.75, y * 1.45 - 0.09, 0.9], [0.87, y * 1.45 + 0.09, 1.03], 1 + r);
        shape.ball([2.02, y * 0.9, 0.68], 0.11, 1 + r);
        shape.ball([-2.02, y * 0.9, 0.7], 0.09, 1 + r);
    }
    shape.pillow([1.95, -0.8, 0.32], [2.18, 0.8, 0.52], 1 + r);
    shape.pillow([-2.18, -0.8, 0.32], [-1.95, 0.8, 0.52], 1 + r);
    shape
}

/// Its cabin's panes: a block that narrows upwards.
fn saloon_panes(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.pillow([-1.3, -0.7, 0.6], [1.05, 0.7, 1.37], 1 + r);
    for p in shape.positions.iter_mut().filter(|p| p[2] > 1.0) {
        *p = [p[0] * 0.85 - 0.05, p[1] * 0.93, p[2]];
    }
    shape
}

fn van(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.pillow([-2.3, -0.95, 0.35], [1.5, 0.95, 2.3], 2 + 2 * r);
    shape.pillow([0.6, -0.92, 0.35], [2.35, 0.92, 1.15], 1 + r);
    for y in [-0.7, 0.7] {
        shape.ball([2.25, y, 0.75], 0.12, 1 + r);
        shape.block([-2.28, y - 0.08, 0.8], [-2.2, y + 0.08, 1.1]);
        shape.pillow([1.35, y * 1.5 - 0.07, 1.2], [1.45, y * 1.5 + 0.07, 1.5], 1 + r);
    }
    shape.block([2.2, -0.85, 0.4], [2.42, 0.85, 0.55]);
    shape
}

/// A van's slanted wind screen and its side windows.
fn van_panes() -> Shape {
    let mut shape = block([0.9, -0.97, 1.25], [1.3, 0.97, 1.85]);
    let (low, high) = ([2.0, 1.08], [1.35, 2.0]);
    let edge = |[x, z]: [f64; 2], y: f64| [x, y, z];
    shape.quad([edge(low, -0.8), edge(low, 0.8), edge(high, 0.72), edge(high, -0.72)]);
    shape
}

/// Four wheels: tyres and hubs.
fn wheels(r: u32) -> Shape {
    let mut shape = Shape::default();
    let across = crate::generate::place::turn([1.0, 0.0, 0.0], 90.0);
    let tyre = torus(0.23, 0.1, 1 + r);
    for (x, y) in [(-1.35, -0.78), (1.35, -0.78), (1.35, 0.78), (-1.35, 0.78)] {
        shape.append(&tyre, &stand([x, y, 0.33], 0.0).after(&across));
        shape.rod([x, y - 0.08, 0.33], [x, y + 0.08, 0.33], 0.16, 1 + r);
    }
    shape
}
