//! How rooms are furnished. All coordinates are a room's own: the door's wall is y = 0, with the door at 0.5 < x < 1.4;
//! the window's wall is y = 5.2; x runs from 0 to 4.4. Angles turn a piece's back, which is at +y.

use super::kit::Kit;
use super::plan::{CLEAR, DEPTH, HALF_WALL, Plan, WIDTH};
use crate::generate::noise::Dice;
use crate::generate::place::stand;
use crate::generate::stage::{Prop, Stage};
use crate::scene::Transform;

/// Furnishes every room but the stairs by its own dice.
pub(super) fn furnish(stage: &mut Stage, plan: &Plan, kit: &Kit, seed: u64) {
    for room in plan.rooms().filter(|&room| !plan.is_stairs(room)) {
        let dice = Dice::new(seed, &[3, room.column.into(), room.row.into(), room.floor.into()]);
        let mut room = Furnishing { stage, kit, dice, at: plan.scene_from_room(room) };
        match room.dice.below(7) {
            0 | 1 => room.office(),
            2 => room.meeting(),
            3 => room.living(),
            4 => room.bedroom(),
            5 => room.kitchen(),
            _ => room.library(),
        }
        room.pictures();
    }
}

/// The inner faces of the walls.
const LEFT: f64 = HALF_WALL;
const RIGHT: f64 = WIDTH - HALF_WALL;
/// Table tops.
const TABLE: f64 = 0.74;

struct Furnishing<'a> {
    stage: &'a mut Stage,
    kit: &'a Kit,
    dice: Dice,
    at: Transform,
}

impl Furnishing<'_> {
    fn put(&mut self, prop: Prop, x: f64, y: f64, z: f64, degrees: f64) {
        self.stage.place(prop, self.at.after(&stand([x, y, z], degrees)));
    }

    /// A piece on the floor, not quite where it should be.
    fn drop_near(&mut self, prop: Prop, x: f64, y: f64, degrees: f64) {
        let (dx, dy) = (self.dice.between(-0.05, 0.05), self.dice.between(-0.05, 0.05));
        let turned = degrees + self.dice.between(-9.0, 9.0);
        self.put(prop, x + dx, y + dy, 0.0, turned);
    }

    fn plant(&mut self, x: f64, y: f64) {
        let (variant, turned) = (self.dice.below(6), self.dice.between(0.0, 360.0));
        for prop in self.kit.plants[variant] {
            self.put(prop, x, y, 0.0, turned);
        }
    }

    fn bookcase(&mut self, x: f64, y: f64, degrees: f64) {
        for prop in self.kit.cases[self.dice.below(6)] {
            self.put(prop, x, y, 0.0, degrees);
        }
    }

    /// A place laid on a table: its eater sits towards -y before it is turned.
    fn setting(&mut self, x: f64, y: f64, degrees: f64) {
        let spot = stand([x, y, TABLE], degrees);
        for (prop, dx, dy) in [(self.kit.plate, 0.0, 0.0), (self.kit.cup, 0.2, 0.12), (self.kit.bowl, -0.22, 0.12)] {
            if self.dice.chance(0.8) {
                self.stage.place(prop, self.at.after(&spot).after(&Transform::translation([dx, dy, 0.0])));
            }
        }
    }

    /// Desk, screen, keyboard, lamp and chair; the worker looks towards the desk's back.
    fn workplace(&mut self, x: f64, y: f64, degrees: f64) {
        let spot = stand([x, y, 0.0], degrees);
        let top = 0.73;
        let mut set = |prop: Prop, p: [f64; 3], turned: f64| {
            self.stage.place(prop, self.at.after(&spot).after(&stand(p, turned)))
        };
        set(self.kit.desk, [0.0, 0.0, 0.0], 0.0);
        set(self.kit.monitor, [-0.15, 0.15, top], self.dice.between(-12.0, 12.0));
        set(self.kit.keyboard, [-0.15, -0.18, top], self.dice.between(-5.0, 5.0));
        set(self.kit.table_lamp, [0.6, 0.2, top], 0.0);
        set(self.kit.cup, [0.35, self.dice.between(-0.2, 0.1), top], self.dice.between(0.0, 360.0));
        let away = self.dice.between(-0.72, -0.6);
        set(self.kit.office_chair, [-0.15, away, 0.0], 180.0 + self.dice.between(-35.0, 35.0));
    }

    fn office(&mut self) {
        self.workplace(RIGHT - 0.42, 3.9, 270.0);
        self.workplace(RIGHT - 0.42, 2.0, 270.0);
        if self.dice.chance(0.7) {
            self.workplace(LEFT + 0.42, 3.8, 90.0);
        }
        self.bookcase(LEFT + 0.16, 2.1, 90.0);
        self.bookcase(2.6, HALF_WALL + 0.16, 180.0);
        self.put(self.kit.bin, RIGHT - 0.2, 2.95, 0.0, 0.0);
        self.plant(RIGHT - 0.45, 0.5);
    }

    fn meeting(&mut self) {
        self.put(self.kit.long_table, 2.2, 2.8, 0.0, 90.0);
        for i in 0..4 {
            let y = 1.85 + 0.63 * f64::from(i);
            self.drop_near(self.kit.chair, 2.2 + 0.72, y, 270.0);
            self.drop_near(self.kit.chair, 2.2 - 0.72, y, 90.0);
            let (near, far) = (self.dice.chance(0.7), self.dice.chance(0.7));
            if near {
                self.setting(2.45, y, 90.0);
            }
            if far {
                self.setting(1.95, y, 270.0);
            }
        }
        self.put(self.kit.vase, 2.2, 2.8, TABLE, 0.0);
        self.bookcase(RIGHT - 0.16, 2.2, 270.0);
        self.bookcase(RIGHT - 0.16, 3.3, 270.0);
        self.plant(0.5, 4.6);
        self.plant(3.9, 0.5);
    }

    fn living(&mut self) {
        self.put(self.kit.rug, 2.2, 2.9, 0.0, 90.0);
        self.put(self.kit.sofa, RIGHT - 0.55, 2.9, 0.0, 270.0);
        self.put(self.kit.low_table, 2.2, 2.9, 0.012, 90.0);
        self.put(self.kit.bowl, 2.2, 3.0, 0.012 + 0.55 * TABLE, 0.0);
        let ear = self.dice.between(0.0, 360.0);
        self.put(self.kit.cup, 2.3, 2.6, 0.012 + 0.55 * TABLE, ear);
        self.drop_near(self.kit.armchair, 1.9, 4.35, 0.0);
        self.put(self.kit.floor_lamp, RIGHT - 0.4, 4.75, 0.0, 0.0);
        self.bookcase(LEFT + 0.16, 2.4, 90.0);
        self.bookcase(LEFT + 0.16, 3.5, 90.0);
        self.put(self.kit.table, 2.9, HALF_WALL + 0.45, 0.0, 0.0);
        self.put(self.kit.vase, 2.5, HALF_WALL + 0.4, TABLE, 0.0);
        self.put(self.kit.table_lamp, 3.4, HALF_WALL + 0.4, TABLE, 0.0);
        self.plant(0.45, 4.7);
    }

    fn bedroom(&mut self) {
        // The bed's head is at the right wall.
        self.put(self.kit.bed, RIGHT - 1.06, 3.0, 0.0, 270.0);
        self.put(self.kit.bedding, RIGHT - 1.06, 3.0, 0.0, 270.0);
        for y in [1.75, 4.25] {
            self.put(self.kit.bin, RIGHT - 0.25, y, 0.0, 0.0);
        }
        self.put(self.kit.wardrobe, 3.0, HALF_WALL + 0.31, 0.0, 180.0);
        self.put(self.kit.rug, 1.3, 3.0, 0.0, 90.0);
        self.put(self.kit.mirror, LEFT, 2.2, 1.2, 90.0);
        self.drop_near(self.kit.armchair, 0.75, 4.3, 45.0);
        self.put(self.kit.floor_lamp, 1.6, 4.75, 0.0, 0.0);
        self.plant(0.45, 3.2);
    }

    fn kitchen(&mut self) {
        // Against the right wall: `counter` begins at its corner, its back is 0.3 behind.
        self.put(self.kit.counter, RIGHT - 0.32, 3.9, 0.0, 270.0);
        self.put(self.kit.fridge, RIGHT - 0.33, 4.4, 0.0, 270.0);
        for i in 0..3 {
            self.put(self.kit.bowl, RIGHT - 0.3, 1.75 + 0.45 * f64::from(i), 0.9, 0.0);
        }
        for i in 0..6 {
            self.put(self.kit.plate, RIGHT - 0.2, 3.1, 0.9 + 0.026 * f64::from(i), 0.0);
        }
        self.put(self.kit.round_table, 1.7, 3.3, 0.0, 0.0);
        for i in 0..4 {
            let degrees = 90.0 * f64::from(i) + 20.0;
            let (sin, cos) = degrees.to_radians().sin_cos();
            self.drop_near(self.kit.chair, 1.7 - 0.78 * sin, 3.3 + 0.78 * cos, degrees);
            self.setting(1.7 - 0.33 * sin, 3.3 + 0.33 * cos, degrees + 180.0);
        }
        self.put(self.kit.vase, 1.7, 3.3, TABLE, 0.0);
        self.bookcase(2.6, HALF_WALL + 0.16, 180.0);
        self.plant(0.45, 4.7);
    }

    fn library(&mut self) {
        for i in 0..3 {
            let y = 1.9 + 1.05 * f64::from(i);
            self.bookcase(RIGHT - 0.16, y, 270.0);
            self.bookcase(LEFT + 0.16, y, 90.0);
            // Back to back in the middle.
            self.bookcase(2.04, y, 270.0);
            self.bookcase(2.36, y, 90.0);
        }
        self.bookcase(2.4, HALF_WALL + 0.16, 180.0);
        self.bookcase(3.5, HALF_WALL + 0.16, 180.0);
        self.drop_near(self.kit.chair, 1.2, 4.6, 0.0);
        self.drop_near(self.kit.chair, 3.2, 4.6, 0.0);
    }

    /// A picture or two above the furniture's height, beside the ceiling.
    fn pictures(&mut self) {
        for (x, degrees) in [(LEFT, 90.0), (RIGHT, 270.0)] {
            if self.dice.chance(0.6) {
                let y = self.dice.between(0.35, 0.65) * DEPTH;
                self.put(self.kit.picture, x, y, CLEAR - 0.4, degrees);
            }
        }
    }
}
