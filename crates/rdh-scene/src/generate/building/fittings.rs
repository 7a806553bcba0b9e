//! What belongs to the house: doors and their frames, window frames, blinds, radiators, lamps, and the corridors' things.

use super::kit::Kit;
use super::plan::{
    CLEAR, CORRIDOR, DEPTH, DOOR, DOOR_HEIGHT, HALF_WALL, OUTER_WALL, Plan, WIDTH, WINDOW, WINDOW_HEIGHTS,
};
use crate::generate::noise::Dice;
use crate::generate::place::stand;
use crate::generate::shape::{Shape, block};
use crate::generate::stage::{Prop, Stage};
use crate::scene::{Material, Transform};

/// A door's leaf with its handles, hinged at the origin and shut along +x, 0.9 m wide.
pub(super) fn door(r: u32) -> Shape {
    let mut shape = block([0.01, -0.02, 0.01], [0.87, 0.02, DOOR_HEIGHT - 0.05]);
    for y in [-1.0, 1.0] {
        shape.rod([0.8, 0.02 * y, 1.0], [0.8, 0.07 * y, 1.0], 0.01, r);
        shape.rod([0.8, 0.07 * y, 1.0], [0.68, 0.07 * y, 1.0], 0.011, r);
        for z in [0.25, 1.2] {
            shape.block([0.15, (0.02 * y).min(0.028 * y), z], [0.72, (0.02 * y).max(0.028 * y), z + 0.65]);
        }
    }
    shape
}

/// A door's frame in a room's own space.
fn door_frame() -> Shape {
    let y = HALF_WALL + 0.02;
    let mut shape = block([DOOR[0] - 0.06, -y, 0.0], [DOOR[0] + 0.01, y, DOOR_HEIGHT + 0.06]);
    shape.block([DOOR[1] - 0.01, -y, 0.0], [DOOR[1] + 0.06, y, DOOR_HEIGHT + 0.06]);
    shape.block([DOOR[0] + 0.01, -y, DOOR_HEIGHT - 0.03], [DOOR[1] - 0.01, y, DOOR_HEIGHT + 0.06]);
    shape
}

/// A window's frame with two posts and a rail, and its sill, in a room's own space.
fn window_frame() -> Shape {
    let (low, high) = (DEPTH + 0.1, DEPTH + 0.18);
    let ([left, right], [sill, head]) = (WINDOW, WINDOW_HEIGHTS);
    let mut shape = block([left, low, sill], [right, high, sill + 0.06]);
    shape.block([left, low, head - 0.06], [right, high, head]);
    for x in [left, left + (right - left) / 3.0 - 0.02, left + (right - left) * 2.0 / 3.0 - 0.02, right - 0.05] {
        shape.block([x, low, sill + 0.06], [x + 0.05, high, head - 0.06]);
    }
    shape.block([left, low + 0.02, sill + 1.05], [right, high - 0.02, sill + 1.09]);
    shape.block([left - 0.08, DEPTH - 0.12, sill - 0.03], [right + 0.08, DEPTH, sill]);
    shape.block([left - 0.04, DEPTH + OUTER_WALL, sill - 0.05], [right + 0.04, DEPTH + OUTER_WALL + 0.08, sill]);
    shape
}

/// Fits out all rooms and corridors.
pub(super) fn fit(stage: &mut Stage, plan: &Plan, kit: &Kit, seed: u64) {
    let wood = stage.material(Material { diffuse: 0.7, ..Material::DIFFUSE });
    let door_frame = stage.prop("door frame", door_frame(), wood);
    let window_frame = stage.prop("window frame", window_frame(), wood);
    for room in plan.rooms() {
        let mut dice = Dice::new(seed, &[1, room.column.into(), room.row.into(), room.floor.into()]);
        let at = plan.scene_from_room(room);
        let mut put = |prop: Prop, x: f64, y: f64, z: f64, degrees: f64| {
            stage.place(prop, at.after(&stand([x, y, z], degrees)));
        };
        put(door_frame, 0.0, 0.0, 0.0, 0.0);
        put(kit.ceiling_lamp, 0.5 * WIDTH, 0.5 * DEPTH, CLEAR, 0.0);
        if !plan.is_stairs(room) {
            // Doors open into the room, hinged on its left, so far that one can walk in.
            put(kit.door, DOOR[0] + 0.01, HALF_WALL, 0.0, dice.between(65.0, 100.0));
        }
        if plan.has_window(room) {
            put(window_frame, 0.0, 0.0, 0.0, 0.0);
            put(kit.radiator, 2.2, DEPTH, 0.0, 0.0);
            if dice.chance(0.6) {
                put(kit.blind, 2.2, DEPTH + 0.05, WINDOW_HEIGHTS[1], 0.0);
            }
        }
    }
    for (floor, corridor) in (0..plan.floors).flat_map(|f| (0..plan.corridors()).map(move |c| (f, c))) {
        let at = Transform::translation([0.0, plan.corridor_y(corridor), plan.floor_z(floor)]);
        fit_corridor(stage, plan, kit, &at, &mut Dice::new(seed, &[2, floor.into(), corridor.into()]));
    }
}

/// Lamps along the middle; benches, plants and pictures at the walls, where no door is.
fn fit_corridor(stage: &mut Stage, plan: &Plan, kit: &Kit, at: &Transform, dice: &mut Dice) {
    for column in 0..plan.rooms_x {
        let x = WIDTH * f64::from(column);
        let mut put = |prop: Prop, x: f64, y: f64, z: f64, degrees: f64| {
            stage.place(prop, at.after(&stand([x, y, z], degrees)));
        };
        put(kit.ceiling_lamp, x + 0.5 * WIDTH, 0.5 * CORRIDOR, CLEAR, 0.0);
        // Doors on the southern side are at the right end of their rooms, on the northern one at the left.
        let (south, north) = (x + 1.3, x + 3.0);
        match dice.below(4) {
            0 => put(kit.bench, south, HALF_WALL + 0.25, 0.0, 0.0),
            1 => kit.plants[dice.below(6)].into_iter().for_each(|prop| put(prop, south, 0.4, 0.0, 0.0)),
            2 => put(kit.bin, south, HALF_WALL + 0.2, 0.0, 0.0),
            _ => put(kit.mirror, south, HALF_WALL, 1.4, 180.0),
        }
        match dice.below(3) {
            0 => put(kit.bench, north, CORRIDOR - HALF_WALL - 0.25, 0.0, 0.0),
            1 => put(kit.armchair, north, CORRIDOR - HALF_WALL - 0.5, 0.0, 0.0),
            _ => {}
        }
        put(kit.picture, north, CORRIDOR - HALF_WALL, 1.6, 0.0);
    }
}
