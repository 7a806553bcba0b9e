//! Where walls, rooms and corridors are. Metres; x along the corridors, z up, the ground floor at z = 0.

use crate::generate::place::stand;
use crate::generate::vector::Point;
use crate::scene::Transform;

/// From room to room along a corridor.
pub(super) const WIDTH: f64 = 4.4;
/// A room's depth, from the corridor's wall to the window.
pub(super) const DEPTH: f64 = 5.2;
/// A corridor's width.
pub(super) const CORRIDOR: f64 = 2.4;
/// From floor to floor.
pub(super) const STOREY: f64 = 3.1;
/// From floor to ceiling.
pub(super) const CLEAR: f64 = 2.8;
/// Half an inner wall.
pub(super) const HALF_WALL: f64 = 0.06;
/// An outer wall, outside of the plan's rectangle.
pub(super) const OUTER_WALL: f64 = 0.3;
/// A door's opening in a room's own x.
pub(super) const DOOR: [f64; 2] = [0.5, 1.4];
/// A door's height.
pub(super) const DOOR_HEIGHT: f64 = 2.1;
/// A window's opening in a room's own x.
pub(super) const WINDOW: [f64; 2] = [1.0, 3.4];
/// A window's sill and head above the floor.
pub(super) const WINDOW_HEIGHTS: [f64; 2] = [0.9, 2.4];

/// The size of a building.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    pub(super) rooms_x: u32,
    pub(super) rooms_y: u32,
    pub(super) floors: u32,
}

/// A room's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Room {
    pub(super) column: u32,
    pub(super) row: u32,
    pub(super) floor: u32,
}

impl Plan {
    /// How many corridors a storey has.
    pub(super) fn corridors(&self) -> u32 {
        self.rooms_y.div_ceil(2)
    }

    /// The y of a corridor's southern wall.
    pub(super) fn corridor_y(&self, corridor: u32) -> f64 {
        f64::from(corridor) * (2.0 * DEPTH + CORRIDOR) + DEPTH
    }

    /// The height of a floor.
    pub(super) fn floor_z(&self, floor: u32) -> f64 {
        STOREY * f64::from(floor)
    }

    /// The rectangle within the outer walls, from the origin.
    pub(super) fn extent(&self) -> [f64; 2] {
        let corridors = f64::from(self.corridors());
        [WIDTH * f64::from(self.rooms_x), f64::from(self.rooms_y) * DEPTH + corridors * CORRIDOR]
    }

    /// All rooms, floor by floor.
    pub(super) fn rooms(self) -> impl Iterator<Item = Room> {
        let row = move |floor, row| (0..self.rooms_x).map(move |column| Room { column, row, floor });
        (0..self.floors).flat_map(move |floor| (0..self.rooms_y).flat_map(move |r| row(floor, r)))
    }

    /// Whether the room's window wall is an outer one.
    pub(super) fn has_window(&self, room: Room) -> bool {
        room.row == 0 || (room.row % 2 == 1 && room.row + 1 == self.rooms_y)
    }

    /// Whether the stairs are there: in the first room, if there is more than one floor.
    pub(super) fn is_stairs(&self, room: Room) -> bool {
        self.floors > 1 && room.row == 0 && room.column == 0
    }

    /// From a room's own space: the corridor's wall is y = 0, the window's y = DEPTH; x runs from 0 to WIDTH.
    pub(super) fn scene_from_room(&self, room: Room) -> Transform {
        let (x, z) = (WIDTH * f64::from(room.column), self.floor_z(room.floor));
        let y = self.corridor_y(room.row / 2);
        // Rooms south of their corridor are turned round.
        if room.row.is_multiple_of(2) { stand([x + WIDTH, y, z], 180.0) } else { stand([x, y + CORRIDOR, z], 0.0) }
    }

    /// A point given in a room's own space.
    pub(super) fn in_room(&self, room: Room, p: Point) -> Point {
        self.scene_from_room(room).point(p)
    }
}
