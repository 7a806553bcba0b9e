//! Slabs, walls with openings, stairs and roof: all boxes.

use super::plan::{
    CLEAR, CORRIDOR, DEPTH, DOOR, DOOR_HEIGHT, HALF_WALL, OUTER_WALL, Plan, Room, STOREY, WIDTH, WINDOW, WINDOW_HEIGHTS,
};
use crate::generate::shape::Shape;
use crate::generate::stage::{Paint, Stage};

/// How far slabs stand out beyond the outer walls.
const LEDGE: f64 = OUTER_WALL + 0.1;
const STEPS: u32 = 17;
const TREAD: f64 = 0.25;
/// Where the stairs begin, in their room's own y.
const STAIRS_FOOT: f64 = 0.6;

/// Builds the shell, storey by storey.
pub(super) fn build(stage: &mut Stage, plan: &Plan, plaster: Paint) {
    for floor in 0..plan.floors {
        stage.add("slab", slab(plan, floor), plaster);
        stage.add("walls", walls(plan, floor), plaster);
        if plan.floors > floor + 1 {
            stage.add("stairs", stairs(plan, floor), plaster);
        }
    }
    stage.add("roof", roof(plan), plaster);
}

/// A floor; those above the ground have a hole over the stairs.
fn slab(plan: &Plan, floor: u32) -> Shape {
    let [x, y] = plan.extent();
    let (low, high) = (plan.floor_z(floor) - (STOREY - CLEAR), plan.floor_z(floor));
    let mut shape = Shape::default();
    let mut plate = |x0: f64, x1: f64, y0: f64, y1: f64| shape.block([x0, y0, low], [x1, y1, high]);
    if floor == 0 || plan.floors == 1 {
        plate(-LEDGE, x + LEDGE, -LEDGE, y + LEDGE);
        return shape;
    }
    let [right, left] = flight(floor - 1).map(|x| WIDTH - x);
    let near = DEPTH - STAIRS_FOOT - 0.3;
    let far = DEPTH - STAIRS_FOOT - TREAD * f64::from(STEPS);
    plate(-LEDGE, x + LEDGE, near, y + LEDGE);
    plate(-LEDGE, x + LEDGE, -LEDGE, far);
    plate(-LEDGE, left - 0.05, far, near);
    plate(right + 0.05, x + LEDGE, far, near);
    shape
}

/// Which part of the stair room's own x a flight takes: they alternate, so that each stands on a floor.
fn flight(floor: u32) -> [f64; 2] {
    if floor.is_multiple_of(2) { [1.75, 2.85] } else { [3.1, 4.2] }
}

/// A flight of solid steps with a rail, from a floor to the next.
fn stairs(plan: &Plan, floor: u32) -> Shape {
    let mut steps = Shape::default();
    let [left, right] = flight(floor);
    let rise = STOREY / f64::from(STEPS + 1);
    for i in 0..STEPS {
        let (y, z) = (STAIRS_FOOT + TREAD * f64::from(i), rise * f64::from(i + 1));
        steps.block([left, y, (z - 0.3).max(0.0)], [right, y + TREAD, z]);
        if i % 4 == 0 {
            steps.rod([left + 0.05, y + 0.1, z], [left + 0.05, y + 0.1, z + 0.9], 0.015, 2);
        }
    }
    let rail = |i: u32| [left + 0.05, STAIRS_FOOT + TREAD * f64::from(i) + 0.1, rise * f64::from(i + 1) + 0.9];
    steps.rod(rail(0), rail(STEPS - 1), 0.03, 2);
    let mut shape = Shape::default();
    shape.append(&steps, &plan.scene_from_room(Room { column: 0, row: 0, floor }));
    shape
}

/// An opening in a wall: its extent along the wall, and heights above the floor.
#[derive(Clone, Copy)]
struct Opening([f64; 2], [f64; 2]);

impl Opening {
    /// A door or window of a room, along x.
    fn of(plan: &Plan, room: Room, along: [f64; 2], heights: [f64; 2]) -> Self {
        let [a, b] = along.map(|x| plan.in_room(room, [x, 0.0, 0.0])[0]);
        Self([a.min(b), a.max(b)], heights)
    }
}

/// A wall as boxes around its openings, which are sorted along it. `axis` is 0 for a wall along x, 1 along y.
fn wall(shape: &mut Shape, axis: usize, along: [f64; 2], across: [f64; 2], z: f64, openings: &[Opening]) {
    let mut piece = |a: f64, b: f64, low: f64, high: f64| {
        let corner = |along: f64, across: f64, z: f64| if axis == 0 { [along, across, z] } else { [across, along, z] };
        if b > a && high > low {
            shape.block(corner(a, across[0], z + low), corner(b, across[1], z + high));
        }
    };
    let mut start = along[0];
    for Opening([a, b], [sill, head]) in openings {
        piece(start, *a, 0.0, CLEAR);
        piece(*a, *b, 0.0, *sill);
        piece(*a, *b, *head, CLEAR);
        start = *b;
    }
    piece(start, along[1], 0.0, CLEAR);
}

/// All walls of a storey.
fn walls(plan: &Plan, floor: u32) -> Shape {
    let [x, y] = plan.extent();
    let z = plan.floor_z(floor);
    let mut shape = Shape::default();
    let rooms = |row: u32| (0..plan.rooms_x).map(move |column| Room { column, row, floor });
    let windows = |row: u32| -> Vec<Opening> {
        let of = |room| Opening::of(plan, room, WINDOW, WINDOW_HEIGHTS);
        rooms(row).map(of).collect()
    };
    let whole = [-OUTER_WALL, x + OUTER_WALL];
    wall(&mut shape, 0, whole, [-OUTER_WALL, 0.0], z, &windows(0));
    let last = plan.rooms_y - 1;
    let north = if last % 2 == 1 { windows(last) } else { Vec::new() };
    wall(&mut shape, 0, whole, [y, y + OUTER_WALL], z, &north);
    for row in 0..plan.rooms_y {
        let of = |room| Opening::of(plan, room, DOOR, [0.0, DOOR_HEIGHT]);
        let doors: Vec<Opening> = rooms(row).map(of).collect();
        let corridor = plan.corridor_y(row / 2);
        let inner = if row.is_multiple_of(2) { corridor } else { corridor + CORRIDOR };
        wall(&mut shape, 0, [0.0, x], [inner - HALF_WALL, inner + HALF_WALL], z, &doors);
        // Between rooms that stand back to back.
        let far = inner + DEPTH;
        if row % 2 == 1 && row + 1 < plan.rooms_y {
            wall(&mut shape, 0, [0.0, x], [far - HALF_WALL, far + HALF_WALL], z, &[]);
        }
        let span =
            if row.is_multiple_of(2) { [inner - DEPTH, inner - HALF_WALL] } else { [inner + HALF_WALL, inner + DEPTH] };
        for column in 1..plan.rooms_x {
            let at = WIDTH * f64::from(column);
            wall(&mut shape, 1, span, [at - HALF_WALL, at + HALF_WALL], z, &[]);
        }
    }
    let ends: Vec<Opening> = (0..plan.corridors())
        .map(|c| Opening([plan.corridor_y(c) + 0.4, plan.corridor_y(c) + CORRIDOR - 0.4], WINDOW_HEIGHTS))
        .collect();
    let entrance = |mut ends: Vec<Opening>| {
        // The way in, at the far end of the first corridor.
        ends[0].1 = [0.0, DOOR_HEIGHT];
        ends
    };
    wall(&mut shape, 1, [0.0, y], [-OUTER_WALL, 0.0], z, &ends);
    let east = if floor == 0 { entrance(ends) } else { ends };
    wall(&mut shape, 1, [0.0, y], [x, x + OUTER_WALL], z, &east);
    shape
}

/// The roof's slab, its parapet, and the stairs' head.
fn roof(plan: &Plan) -> Shape {
    let [x, y] = plan.extent();
    let z = plan.floor_z(plan.floors);
    let mut shape = Shape::default();
    shape.block([-LEDGE, -LEDGE, z - (STOREY - CLEAR)], [x + LEDGE, y + LEDGE, z]);
    let (low, high) = ([-LEDGE, -LEDGE, z], [x + LEDGE, y + LEDGE, z + 0.7]);
    shape.block(low, [high[0], low[1] + 0.2, high[2]]);
    shape.block([low[0], high[1] - 0.2, z], high);
    shape.block([low[0], low[1] + 0.2, z], [low[0] + 0.2, high[1] - 0.2, high[2]]);
    shape.block([high[0] - 0.2, low[1] + 0.2, z], [high[0], high[1] - 0.2, high[2]]);
    if plan.floors > 1 {
        shape.block([0.8, 0.8, z], [WIDTH - 0.8, DEPTH - 1.2, z + 2.4]);
    }
    shape
}
