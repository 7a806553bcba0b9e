//! Views, lights and the walk through a building.

use super::plan::{CLEAR, CORRIDOR, DEPTH, Plan, Room, STOREY, WIDTH};
use crate::camera::View;
use crate::generate::stage::view;
use crate::generate::vector::{Point, add};
use crate::path::CameraPath;

const UP: Point = [0.0, 0.0, 1.0];
/// A walker's eyes.
const EYES: f64 = 1.6;

/// A room on the middle floor, in the middle of a row with windows.
fn middle_room(plan: &Plan) -> Room {
    Room { column: plan.rooms_x / 2, row: u32::from(plan.rooms_y == 2), floor: (plan.floors - 1) / 2 }
}

/// A point in a corridor, `x` from the building's western wall.
fn in_corridor(plan: &Plan, floor: u32, x: f64, z: f64) -> Point {
    [x, plan.corridor_y(0) + 0.5 * CORRIDOR, plan.floor_z(floor) + z]
}

/// From the corridor, from three places in rooms, and from outside.
pub(super) fn views(plan: &Plan) -> Vec<View> {
    let room = middle_room(plan);
    let here = |p: Point| plan.in_room(room, p);
    let [x, y] = plan.extent();
    let height = STOREY * f64::from(plan.floors);
    let far = 0.75 * (x + y + height);
    let corner = [x + 0.55 * far, -0.65 * far, 0.6 * height + 1.7];
    vec![
        view(
            "corridor",
            in_corridor(plan, room.floor, 0.6, EYES),
            in_corridor(plan, room.floor, x, EYES - 0.25),
            UP,
            65.0,
        ),
        view("room", here([1.4, 0.85, EYES]), here([2.6, 4.4, 0.9]), UP, 70.0),
        view("window", here([3.4, 4.75, 1.45]), here([1.2, 0.6, 0.9]), UP, 70.0),
        view("across", here([0.5, 2.95, 1.15]), here([3.6, 2.7, 0.75]), UP, 60.0),
        view("outside", corner, [0.5 * x, 0.4 * y, 0.45 * height], UP, 40.0),
    ]
}

/// Lamps in the rooms and corridors that the views show, and the sun: seven at most, whatever the size.
pub(super) fn lights(plan: &Plan) -> Vec<Point> {
    let room = middle_room(plan);
    let below_lamp = CLEAR - 0.55;
    let [x, y] = plan.extent();
    let lamp = |column: u32| {
        let room = Room { column, ..room };
        plan.in_room(room, [0.5 * WIDTH, 0.5 * DEPTH, below_lamp])
    };
    let mut lights = vec![lamp(room.column), add([0.6 * x, -0.4 * y, 0.0], [200.0, -400.0, 300.0])];
    if room.column > 0 {
        lights.push(lamp(room.column - 1));
    }
    let along = |i: u32| in_corridor(plan, room.floor, (f64::from(i) + 0.5) * x / 4.0, below_lamp);
    lights.extend((0..4).map(along));
    lights
}

/// Along the corridor, into the middle room, and round in it.
pub(super) fn paths(plan: &Plan) -> Vec<CameraPath> {
    let room = middle_room(plan);
    let here = |x: f64, y: f64, z: f64| plan.in_room(room, [x, y, z]);
    let door = here(1.15, -0.5 * CORRIDOR, EYES)[0];
    let from = in_corridor(plan, room.floor, 0.6, EYES);
    let halfway = in_corridor(plan, room.floor, 0.5 * (0.6 + door), EYES);
    let keys = [
        (from, in_corridor(plan, room.floor, door, EYES)),
        (halfway, in_corridor(plan, room.floor, door + 2.0, EYES)),
        (here(1.15, -0.5 * CORRIDOR, EYES), here(1.15, 1.5, EYES - 0.1)),
        (here(1.17, 0.7, EYES), here(2.2, 4.0, 1.1)),
        (here(1.3, 1.3, EYES), here(4.0, 2.6, 1.0)),
    ];
    let views = keys.into_iter().map(|(eye, target)| view("walk", eye, target, UP, 65.0)).collect();
    vec![CameraPath { name: "walk".to_owned(), views, frames: 120 }]
}
