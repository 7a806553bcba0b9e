//! Procedural scenes of any size, the same on every machine for the same parameters.
//!
//! A generator is named by a table: `generator = "balls"`, and its parameters. To add one: a struct of parameters that
//! implements `Generator`, one row in `GENERATORS`, and a TOML with its views in `scenes/`.
//!
//! Positions come from `sin`, `cos` and `exp`, which may differ in their last bit between platforms; which parts there
//! are, and how many, never depends on them. Everything is built from instances of few geometries.

mod building;
mod city;
mod forest;
mod noise;
mod place;
mod props;
mod round;
mod shape;
mod spd;
mod stage;
mod terrain;
mod text;
mod vector;

use std::fmt;
use std::ops::RangeInclusive;

use serde::de::DeserializeOwned;

use crate::camera::View;
use crate::error::{Error, Result};
use crate::path::CameraPath;
use crate::scene::Scene;
pub use text::{format_call, parse_call};

/// No generator makes more triangles than this.
pub const MAX_TRIANGLES: f64 = 50e6;

/// A procedural scene with its parameters.
pub(crate) trait Generator: fmt::Debug {
    /// Whether the parameters are in range.
    fn check(&self) -> Result<()>;

    /// An upper bound of its triangles, known without making anything.
    fn triangles_at_most(&self) -> f64;

    /// Its views at any parameters in range; the first is the usual one.
    fn views(&self) -> Vec<View>;

    /// Ways through it.
    fn paths(&self) -> Vec<CameraPath> {
        Vec::new()
    }

    /// The scene at a frame, without views. Only called when the parameters are in range.
    fn scene(&self, frame: u32) -> Scene;
}

type Read = fn(toml::Table) -> Result<Box<dyn Generator>>;

/// All generators by name.
const GENERATORS: &[(&str, Read)] = &[
    ("balls", read::<spd::Balls>),
    ("gears", read::<spd::Gears>),
    ("jacks", read::<spd::Jacks>),
    ("lattice", read::<spd::Lattice>),
    ("mount", read::<spd::Mount>),
    ("rings", read::<spd::Rings>),
    ("shells", read::<spd::Shells>),
    ("sombrero", read::<spd::Sombrero>),
    ("teapot", read::<spd::Teapot>),
    ("tetra", read::<spd::Tetra>),
    ("tree", read::<spd::Tree>),
    ("building", read::<building::Building>),
    ("city", read::<city::City>),
    ("forest", read::<forest::Forest>),
    ("terrain", read::<terrain::Terrain>),
];

/// The names of all generators.
pub fn names() -> impl Iterator<Item = &'static str> {
    GENERATORS.iter().map(|&(name, _)| name)
}

/// Makes the scene that a table describes, at a frame (0 for the scene at rest).
///
/// # Errors
/// An unknown generator or parameter, naming the known ones; a parameter out of range; more than [`MAX_TRIANGLES`].
pub fn make(table: &toml::Table, frame: u32) -> Result<Scene> {
    let generator = checked(table)?;
    Ok(Scene { views: generator.views(), ..generator.scene(frame) })
}

/// The views of the scene that a table describes, without making it.
///
/// # Errors
/// As [`make`].
pub fn views(table: &toml::Table) -> Result<Vec<View>> {
    Ok(checked(table)?.views())
}

/// The camera paths through the scene that a table describes.
///
/// # Errors
/// As [`make`].
pub fn paths(table: &toml::Table) -> Result<Vec<CameraPath>> {
    Ok(checked(table)?.paths())
}

/// Reads a table and refuses what is out of range or too large.
fn checked(table: &toml::Table) -> Result<Box<dyn Generator>> {
    let generator = read_table(table)?;
    generator.check().map_err(|e| Error::at(format_call(table), format!("{}: {}", e.place, e.reason)))?;
    let most = generator.triangles_at_most();
    if most > MAX_TRIANGLES {
        let reason = format!("up to {most:.3e} triangles; the limit is {MAX_TRIANGLES:.0e}");
        return Err(Error::at(format_call(table), reason));
    }
    Ok(generator)
}

fn read_table(table: &toml::Table) -> Result<Box<dyn Generator>> {
    let mut parameters = table.clone();
    let name = match parameters.remove("generator") {
        Some(toml::Value::String(name)) => name,
        _ => return Err(Error::whole("generator = \"…\" is missing")),
    };
    let Some((_, read)) = GENERATORS.iter().find(|(known, _)| *known == name) else {
        let known: Vec<&str> = names().collect();
        return Err(Error::whole(format!("unknown generator `{name}`; there are {}", known.join(", "))));
    };
    read(parameters).map_err(|e| Error::at(name, e.reason))
}

fn read<G: Generator + DeserializeOwned + 'static>(parameters: toml::Table) -> Result<Box<dyn Generator>> {
    let generator: G = parameters.try_into().map_err(|e: toml::de::Error| Error::whole(e.message()))?;
    Ok(Box::new(generator))
}

/// Checks a parameter's range.
fn within(name: &str, value: u32, range: RangeInclusive<u32>) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = range.into_inner();
    Err(Error::at(name, format!("{value} is out of range; {least} to {most} are possible")))
}

#[cfg(test)]
mod tests;
