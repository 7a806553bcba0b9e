//! Houses: a core of panes behind a grid of bands and piers, with sills, mullions, balconies and roofs.

use super::Paints;
use super::layout::{LOT, Layout, PAVEMENT};
use crate::generate::noise::Dice;
use crate::generate::place::{stand, turn};
use crate::generate::shape::{Shape, block};
use crate::generate::stage::{Prop, Stage};

/// Kinds of houses.
const KINDS: usize = 8;
/// Half a house's side.
const HALF: f64 = 9.25;
/// How far the panes lie behind the walls.
const RECESS: f64 = 0.3;
/// Bays of each side.
const BAYS: u32 = 5;
const STOREY: f64 = 3.2;
const GROUND_STOREY: f64 = 4.2;
const PIER: f64 = 0.45;

/// What a house looks like.
struct Style {
    storeys: u32,
    balconies: bool,
    pitched: bool,
    /// Height of the wall below a window.
    parapet: f64,
}

impl Style {
    fn new(kind: usize, dice: &mut Dice) -> Self {
        // From low, pitched houses to towers.
        let storeys = [2, 3, 4, 5, 6, 8, 10, 13][kind] + u32::from(dice.chance(0.5));
        Self { storeys, balconies: kind % 3 == 1, pitched: kind < 2, parapet: dice.between(0.6, 1.1) }
    }

    /// The floor of a storey.
    fn floor(&self, storey: u32) -> f64 {
        if storey == 0 { 0.0 } else { GROUND_STOREY + STOREY * f64::from(storey - 1) }
    }

    fn top(&self) -> f64 {
        self.floor(self.storeys)
    }
}

/// Builds the houses of all blocks that aren't parks.
pub(super) fn build(stage: &mut Stage, layout: &Layout, paints: &Paints, detail: u32) {
    let kinds: Vec<[Prop; 2]> = (0..KINDS).map(|kind| house(stage, layout.seed, kind, paints, detail)).collect();
    for at in layout.blocks().filter(|&b| !layout.is_park(b)) {
        let mut dice = layout.dice(2, at);
        let [x, y] = layout.centre(at);
        for (dx, dy) in [(-LOT, -LOT), (LOT, -LOT), (LOT, LOT), (-LOT, LOT)] {
            let kind = kinds[dice.below(KINDS)];
            let turned = 90.0 * dice.below(4) as f64;
            kind.into_iter().for_each(|prop| stage.place(prop, stand([x + dx, y + dy, PAVEMENT], turned)));
        }
    }
}

fn house(stage: &mut Stage, seed: u64, kind: usize, paints: &Paints, detail: u32) -> [Prop; 2] {
    let mut dice = Dice::new(seed, &[-2, kind as i64]);
    let style = Style::new(kind, &mut dice);
    let inner = HALF - RECESS;
    // The core's foot is in the ground, where nobody sees that it has a floor.
    let core = block([-inner, -inner, -0.1], [inner, inner, style.top() - 0.1]);
    let mut walls = Shape::default();
    let side = side(&style, detail);
    for quarter in 0..4 {
        walls.append(&side, &turn([0.0, 0.0, 1.0], 90.0 * f64::from(quarter)));
    }
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        corner(&mut walls, x, y, style.top());
    }
    if style.pitched {
        hip(&mut walls, style.top())
    } else {
        flat_roof(&mut walls, style.top(), &mut dice, detail)
    }
    [stage.prop("panes", core, paints.pane), stage.prop("house", walls, paints.wall)]
}

/// The pillar at a corner.
fn corner(walls: &mut Shape, x: f64, y: f64, top: f64) {
    let (near, far) = (HALF - 0.8, HALF);
    let range = |s: f64| if s < 0.0 { [-far, -near] } else { [near, far] };
    let ([x0, x1], [y0, y1]) = (range(x), range(y));
    walls.block([x0, y0, 0.0], [x1, y1, top]);
}

/// The side that looks to -y, between the corners: bands, piers, and what each window has.
fn side(style: &Style, detail: u32) -> Shape {
    let (edge, out, back) = (HALF - 0.8, -HALF, -HALF + RECESS + 0.01);
    let mut shape = Shape::default();
    for storey in 1..=style.storeys {
        let z = style.floor(storey);
        let high = if storey == style.storeys { z } else { z + style.parapet };
        shape.block([-edge, out + 0.05, z - 0.5], [edge, back, high]);
    }
    let bay = 2.0 * edge / f64::from(BAYS);
    for i in 1..BAYS {
        let x = bay * f64::from(i) - edge;
        shape.block([x - PIER / 2.0, out, 0.0], [x + PIER / 2.0, back, style.top()]);
    }
    for i in 0..BAYS {
        let middle = bay * (f64::from(i) + 0.5) - edge;
        ground_floor(&mut shape, middle, bay, i == BAYS / 2, detail);
        for storey in 1..style.storeys {
            let balcony = style.balconies && (i + storey) % 2 == 0;
            window(&mut shape, style, middle, bay, storey, balcony, detail);
        }
    }
    shape
}

/// A shop window with its step and posts, or the house's door with a canopy.
fn ground_floor(shape: &mut Shape, middle: f64, bay: f64, is_door: bool, detail: u32) {
    let (half, out, back) = ((bay - PIER) / 2.0, -HALF, -HALF + RECESS + 0.01);
    if is_door {
        shape.block([middle - half, out - 1.2, 2.9], [middle + half, out + 0.04, 3.05]);
        shape.block([middle - half, out - 0.5, 0.0], [middle + half, back, 0.12]);
        shape.rod([middle + 0.5, out + 0.2, 1.0], [middle + 0.5, out + 0.2, 1.4], 0.03, detail);
        shape.block([middle - 0.03, out + 0.15, 0.12], [middle + 0.03, back, 3.7]);
        return;
    }
    shape.block([middle - half, out + 0.02, 0.0], [middle + half, back, 0.5]);
    for part in 1..=detail {
        let x = middle - half + 2.0 * half * f64::from(part) / f64::from(detail + 1);
        shape.block([x - 0.04, out + 0.12, 0.5], [x + 0.04, back, 3.7]);
    }
}

fn window(shape: &mut Shape, style: &Style, middle: f64, bay: f64, storey: u32, balcony: bool, detail: u32) {
    let (half, out, back) = ((bay - PIER) / 2.0, -HALF, -HALF + RECESS + 0.01);
    let (z, head) = (style.floor(storey), style.floor(storey + 1) - 0.5);
    let sill = z + style.parapet;
    shape.block([middle - half, out - 0.06, sill], [middle + half, back, sill + 0.05]);
    for part in 1..=detail {
        let x = middle - half + 2.0 * half * f64::from(part) / f64::from(detail + 1);
        shape.block([x - 0.03, out + 0.16, sill + 0.05], [x + 0.03, back, head]);
    }
    for part in 1..detail {
        let z = sill + 0.05 + (head - sill - 0.05) * f64::from(part) / f64::from(detail);
        shape.block([middle - half, out + 0.18, z - 0.02], [middle + half, back, z + 0.02]);
    }
    if balcony {
        railing(shape, middle, half, z, detail);
    }
}

/// A balcony's slab and its rail on bars.
fn railing(shape: &mut Shape, middle: f64, half: f64, z: f64, detail: u32) {
    let (out, depth) = (-HALF, 1.1);
    shape.block([middle - half, out - depth, z - 0.15], [middle + half, out + 0.04, z]);
    shape.block([middle - half, out - depth, z + 0.95], [middle + half, out - depth + 0.05, z + 1.0]);
    for x in [middle - half, middle + half - 0.05] {
        shape.block([x, out - depth + 0.05, z + 0.95], [x + 0.05, out, z + 1.0]);
    }
    let bars = 3 + 3 * detail;
    for bar in 0..=bars {
        let x = middle - half + (2.0 * half - 0.03) * f64::from(bar) / f64::from(bars);
        shape.block([x, out - depth + 0.01, z], [x + 0.03, out - depth + 0.04, z + 0.95]);
    }
}

/// A parapet, and machinery: boxes with fans, a tank, pipes and an aerial.
fn flat_roof(walls: &mut Shape, top: f64, dice: &mut Dice, detail: u32) {
    walls.block([-HALF, -HALF, top], [HALF, HALF, top + 0.1]);
    let (out, inner, z) = (HALF, HALF - 0.25, top + 0.1);
    walls.block([-out, -out, z], [out, -inner, z + 0.8]);
    walls.block([-out, inner, z], [out, out, z + 0.8]);
    walls.block([-out, -inner, z], [-inner, inner, z + 0.8]);
    walls.block([inner, -inner, z], [out, inner, z + 0.8]);
    walls.block([-2.0, 1.0, z], [2.0, 6.0, z + 2.6]);
    for i in 0..3 + detail {
        let [x, y] = [-6.5 + 13.0 * f64::from(i) / f64::from(2 + detail), dice.between(-6.5, -1.5)];
        walls.block([x - 0.7, y - 0.5, z + 0.15], [x + 0.7, y + 0.5, z + 1.1]);
        walls.rod([x, y, z + 1.1], [x, y, z + 1.25], 0.4, 1 + detail);
        walls.block([x - 0.6, y - 0.4, z], [x - 0.5, y + 0.4, z + 0.15]);
        walls.block([x + 0.5, y - 0.4, z], [x + 0.6, y + 0.4, z + 0.15]);
    }
    let [x, y] = [5.5, 4.5];
    for (dx, dy) in [(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)] {
        walls.rod([x + dx, y + dy, z], [x + dx, y + dy, z + 1.6], 0.08, 1);
    }
    let tank = [[0.0, 1.6], [1.4, 1.6], [1.4, 3.6], [0.0, 4.3]];
    walls.turned(&tank, [x, y, z], 1 + 2 * detail);
    walls.rod([-5.5, 4.5, z], [-5.5, 4.5, z + 5.0], 0.05, detail);
    for i in 0..4 {
        let h = z + 3.2 + 0.4 * f64::from(i);
        walls.rod([-6.2, 4.5, h], [-4.8, 4.5, h], 0.02, 1);
    }
}

/// A hipped roof with a chimney.
fn hip(walls: &mut Shape, top: f64) {
    let (eave, ridge) = (HALF + 0.5, 3.5);
    let low = [[-eave, -eave, top], [eave, -eave, top], [eave, eave, top], [-eave, eave, top]];
    let [a, b, c, d] = low.map(|p| walls.vertex(p));
    let [e, f] = [[-ridge, 0.0, top + 4.2], [ridge, 0.0, top + 4.2]].map(|p| walls.vertex(p));
    walls.quad_of([d, c, b, a]);
    walls.quad_of([a, b, f, e]);
    walls.quad_of([c, d, e, f]);
    walls.triangles.extend([[b, c, f], [d, a, e]]);
    walls.block([3.0, 1.6, top + 1.0], [4.0, 2.6, top + 5.2]);
    walls.block([2.9, 1.5, top + 5.2], [4.1, 2.7, top + 5.4]);
}
