//! A fractal landscape: a height field over a square of 1,000 m, from octaves of value noise.
//!
//! Heights are sums of products of integer hashes: the same bits on every platform. Broad hills carry ridged noise,
//! 1 - |n|, in octaves that shrink by 1.9 and weaken by 0.48 each, so that crests are sharp and valleys smooth.

use super::noise::value_noise;
use super::round::sheet;
use super::stage::{Stage, view};
use super::vector::Point;
use super::{Generator, within};
use crate::camera::View;
use crate::error::Result;
use crate::path::CameraPath;
use crate::scene::{Material, Scene};

/// 2·cells² triangles.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Terrain {
    /// Cells along each side.
    pub(crate) cells: u32,
    /// Which landscape.
    pub(crate) seed: u32,
}

impl Default for Terrain {
    fn default() -> Self {
        Self { cells: 256, seed: 1 }
    }
}

const SIDE: f64 = 1_000.0;
const Z_UP: Point = [0.0, 0.0, 1.0];

impl Terrain {
    /// Height of the ground at a place.
    fn height(&self, x: f64, y: f64) -> f64 {
        let seed = u64::from(self.seed) << 8;
        let (mut u, mut v) = (x / 420.0, y / 420.0);
        let mut height = 55.0 * value_noise(seed, u, v);
        let mut weight = 70.0;
        for octave in 1..9 {
            // Each octave is turned by an angle of tangent 3/4, which hides the noise's grid.
            (u, v) = (1.9 * (0.8 * u - 0.6 * v) + 0.37, 1.9 * (0.6 * u + 0.8 * v) + 0.61);
            height += weight * (1.0 - value_noise(seed | octave, u, v).abs());
            weight *= 0.48;
        }
        height
    }

    /// A point at some height above the ground.
    fn above(&self, x: f64, y: f64, by: f64) -> Point {
        [x, y, self.height(x, y) + by]
    }
}

impl Generator for Terrain {
    fn check(&self) -> Result<()> {
        within("cells", self.cells, 2..=5_000)
    }

    fn triangles_at_most(&self) -> f64 {
        2.0 * f64::from(self.cells).powi(2)
    }

    fn views(&self) -> Vec<View> {
        let valley = self.above(-140.0, -180.0, 30.0);
        vec![
            view("overlook", self.above(-430.0, -430.0, 130.0), self.above(60.0, 80.0, -20.0), Z_UP, 50.0),
            view("valley", valley, self.above(200.0, 60.0, 10.0), Z_UP, 60.0),
            view("above", [0.0, -60.0, 900.0], self.above(0.0, 0.0, 0.0), Z_UP, 50.0),
        ]
    }

    fn paths(&self) -> Vec<CameraPath> {
        let step = |i: u32| self.above(-380.0 + 150.0 * f64::from(i), -300.0 + 110.0 * f64::from(i), 60.0);
        let views = (0..5).map(|i| view("flight", step(i), step(i + 1), Z_UP, 60.0)).collect();
        vec![CameraPath { name: "flight".to_owned(), views, frames: 96 }]
    }

    fn scene(&self, _frame: u32) -> Scene {
        let mut stage = Stage::new("terrain", Z_UP);
        let rock = stage.material(Material { diffuse: 0.6, ..Material::DIFFUSE });
        let place = |u: f64, v: f64| self.above((u - 0.5) * SIDE, (v - 0.5) * SIDE, 0.0);
        stage.add("ground", sheet(self.cells, self.cells, place), rock);
        stage.lights(&[[600.0, -900.0, 1_200.0]]);
        stage.finish()
    }
}
