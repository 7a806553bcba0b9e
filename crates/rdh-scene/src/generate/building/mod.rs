//! A building of furnished rooms: storeys of rooms along corridors, with doors, windows, stairs and furniture.
//!
//! Rooms stand in rows of `rooms_x`; two rows share a corridor between them, and pairs of rows stand back to back
//! (rooms there have no window). Each room is furnished as one of seven kinds by its own dice, so that the same seed
//! gives the same room in a building of any size. There is no glass in the windows and no ceiling but the next floor.
//!
//! Doors stand open, so that corridors and rooms see into each other; still most of the building is hidden from any
//! one point.

mod fittings;
mod kit;
mod plan;
mod rooms;
mod views;
mod walls;

use super::shape::ground;
use super::stage::Stage;
use super::{Generator, within};
use crate::camera::View;
use crate::error::Result;
use crate::path::CameraPath;
use crate::scene::{Material, Scene};
use kit::Kit;
use plan::Plan;

/// The parameters of a building.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Building {
    /// Rooms along each side of a corridor.
    pub(crate) rooms_x: u32,
    /// Rows of rooms.
    pub(crate) rooms_y: u32,
    /// Storeys.
    pub(crate) floors: u32,
    /// How finely round things are cut: a quarter circle into `detail` to `6·detail` parts.
    pub(crate) detail: u32,
    /// Which furniture stands where.
    pub(crate) seed: u32,
}

impl Default for Building {
    fn default() -> Self {
        Self { rooms_x: 4, rooms_y: 2, floors: 3, detail: 2, seed: 1 }
    }
}

impl Building {
    fn plan(&self) -> Plan {
        Plan { rooms_x: self.rooms_x, rooms_y: self.rooms_y, floors: self.floors }
    }
}

impl Generator for Building {
    fn check(&self) -> Result<()> {
        within("rooms_x", self.rooms_x, 1..=1_000)?;
        within("rooms_y", self.rooms_y, 1..=1_000)?;
        within("floors", self.floors, 1..=200)?;
        within("detail", self.detail, 1..=8)
    }

    /// More than the fullest kind of room, its share of the corridor, and the walls have; tests compare it with counts.
    fn triangles_at_most(&self) -> f64 {
        let rooms = f64::from(self.rooms_x) * f64::from(self.rooms_y) * f64::from(self.floors);
        let detail = f64::from(self.detail);
        10_000.0 + (rooms + 2.0) * (9_000.0 + 4_000.0 * detail + 3_000.0 * detail * detail)
    }

    fn views(&self) -> Vec<View> {
        views::views(&self.plan())
    }

    fn paths(&self) -> Vec<CameraPath> {
        views::paths(&self.plan())
    }

    fn scene(&self, _frame: u32) -> Scene {
        let plan = self.plan();
        let mut stage = Stage::new("building", [0.0, 0.0, 1.0]);
        let grass = stage.material(Material { diffuse: 0.4, ..Material::DIFFUSE });
        let [x, y] = plan.extent();
        stage.add("ground", ground([-40.0, -40.0], [x + 40.0, y + 40.0], -0.15), grass);
        let plaster = stage.material(Material::DIFFUSE);
        walls::build(&mut stage, &plan, plaster);
        let kit = Kit::new(&mut stage, self.detail, u64::from(self.seed));
        fittings::fit(&mut stage, &plan, &kit, u64::from(self.seed));
        rooms::furnish(&mut stage, &plan, &kit, u64::from(self.seed));
        stage.lights(&views::lights(&plan));
        stage.finish()
    }
}
