//! A city: a grid of streets, blocks of houses and parks, trees, street furniture, and traffic.
//!
//! Houses come in eight kinds, grown once from the seed; each stands turned in one of a block's four lots, which leave
//! alleys between them. Every seventh block or so is a park. The frame moves the cars of the streets along x by half a
//! metre or more each; those of the cross streets wait at the corners. The sun is the only light.

mod cars;
mod houses;
mod layout;
mod street;

use super::stage::{Stage, view};
use super::vector::Point;
use super::{Generator, within};
use crate::camera::View;
use crate::error::Result;
use crate::path::CameraPath;
use crate::scene::{Material, Scene};
use layout::{Layout, PITCH};

/// The parameters of a city.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct City {
    /// Blocks along x.
    pub(crate) blocks_x: u32,
    /// Blocks along y.
    pub(crate) blocks_y: u32,
    /// How finely houses, trees and round things are cut.
    pub(crate) detail: u32,
    /// Which city.
    pub(crate) seed: u32,
}

impl Default for City {
    fn default() -> Self {
        Self { blocks_x: 4, blocks_y: 4, detail: 2, seed: 1 }
    }
}

const UP: Point = [0.0, 0.0, 1.0];

impl City {
    fn layout(&self) -> Layout {
        Layout { blocks_x: self.blocks_x, blocks_y: self.blocks_y, seed: self.seed.into() }
    }
}

impl Generator for City {
    fn check(&self) -> Result<()> {
        within("blocks_x", self.blocks_x, 1..=500)?;
        within("blocks_y", self.blocks_y, 1..=500)?;
        within("detail", self.detail, 1..=6)
    }

    /// More than four of the highest houses and a block's share of the streets have; tests compare it with counts.
    fn triangles_at_most(&self) -> f64 {
        let blocks = f64::from(self.blocks_x + 1) * f64::from(self.blocks_y + 1);
        let detail = f64::from(self.detail);
        blocks * (40_000.0 + 30_000.0 * detail + 12_000.0 * detail * detail) + 100.0
    }

    fn views(&self) -> Vec<View> {
        let layout = self.layout();
        let [x, y] = layout.extent();
        let [bx, by] = layout.middle_block();
        let street = PITCH * f64::from(self.blocks_y / 2);
        let corner = PITCH * f64::from(self.blocks_x / 2);
        vec![
            view("street", [-4.0, street, 1.7], [0.6 * x, street, 3.0], UP, 60.0),
            view("corner", [corner - 9.5, street + 8.3, 1.7], [corner + 10.0, street + 22.0, 5.5], UP, 75.0),
            view("alley", [bx - 18.5, by, 1.7], [bx + 20.0, by + 0.2, 3.2], UP, 60.0),
            view("window", [corner + 3.0, street + 0.5, 14.0], [corner + 45.0, street - 5.0, 4.0], UP, 65.0),
            view("above", [-0.35 * x - 20.0, -0.5 * y - 20.0, 60.0 + 0.35 * x], [0.45 * x, 0.45 * y, 5.0], UP, 45.0),
        ]
    }

    fn paths(&self) -> Vec<CameraPath> {
        let street = PITCH * f64::from(self.blocks_y / 2);
        let length = PITCH * f64::from(self.blocks_x);
        let key = |i: u32| {
            let x = length * f64::from(i) / 6.0;
            view("drive", [x, street, 1.5], [x + 20.0, street, 2.5], UP, 65.0)
        };
        vec![CameraPath { name: "drive".to_owned(), views: (0..7).map(key).collect(), frames: 120 }]
    }

    fn scene(&self, frame: u32) -> Scene {
        let layout = self.layout();
        let mut stage = Stage::new("city", UP);
        let paints = Paints::new(&mut stage);
        street::pave(&mut stage, &layout, &paints);
        houses::build(&mut stage, &layout, &paints, self.detail);
        street::furnish(&mut stage, &layout, &paints, self.detail);
        cars::drive(&mut stage, &layout, &paints, self.detail, frame);
        let [x, y] = layout.extent();
        stage.lights(&[[0.5 * x - 700.0, 0.5 * y - 450.0, 900.0]]);
        stage.finish()
    }
}

/// What the city is made of.
struct Paints {
    asphalt: super::stage::Paint,
    stone: super::stage::Paint,
    wall: super::stage::Paint,
    pane: super::stage::Paint,
    metal: super::stage::Paint,
    car: super::stage::Paint,
    green: super::stage::Paint,
    bark: super::stage::Paint,
    white: super::stage::Paint,
}

impl Paints {
    fn new(stage: &mut Stage) -> Self {
        let mut paint =
            |diffuse: f32, mirror: f32| stage.material(Material { diffuse, mirror, transmission: 0.0, index: 1.0 });
        Self {
            asphalt: paint(0.2, 0.0),
            stone: paint(0.5, 0.0),
            wall: paint(0.6, 0.0),
            pane: paint(0.1, 0.5),
            metal: paint(0.4, 0.2),
            car: paint(0.5, 0.2),
            green: paint(0.4, 0.0),
            bark: paint(0.3, 0.0),
            white: paint(0.8, 0.0),
        }
    }
}
