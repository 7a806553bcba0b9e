//! What scenes there are: the embedded ones, and those of a folder with a `scenes.toml`.

mod embedded;
mod find;
mod near;
mod overview;

use std::path::Path;

use crate::camera::View;
use crate::error::Result;
use crate::generate;
use crate::index::{self, Files};
use crate::path::CameraPath;
use crate::scene::{Kind, Scene};
pub use embedded::embedded;
pub use find::{find, split_view};

/// A scene that can be loaded.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Its id: `balls4`, `country-kitchen`.
    pub id: String,
    /// How it occludes itself.
    pub kind: Kind,
    /// How many triangles it has, all instances counted, as its index states.
    pub triangles: usize,
    /// One line about it.
    pub about: String,
    /// Its views; the first is the usual one.
    pub views: Vec<View>,
    /// How many frames it has: 1 if nothing moves.
    pub frames: u32,
    /// Whether it belongs to the quick set that `compare` takes without arguments.
    pub quick: bool,
    /// Where it comes from.
    pub source: Source,
}

/// Where a scene comes from.
#[derive(Debug, Clone)]
pub enum Source {
    /// One of the generators, with its parameters as in its TOML.
    Generator(toml::Table),
    /// Mesh files, joined.
    Files(Files),
}

/// The scenes of a folder's `scenes.toml`, in order.
///
/// # Errors
/// A missing or malformed index, naming file and line.
pub fn indexed(folder: &Path) -> Result<Vec<Entry>> {
    index::read_index(folder)
}

impl Entry {
    /// The camera paths through the scene; files have none.
    ///
    /// # Errors
    /// What the generator says.
    pub fn paths(&self) -> Result<Vec<CameraPath>> {
        match &self.source {
            Source::Generator(table) => generate::paths(table),
            Source::Files(_) => Ok(Vec::new()),
        }
    }

    /// Reads or makes the scene at a frame (0 for the scene at rest).
    ///
    /// # Errors
    /// What the reader or generator says.
    pub fn load(&self, frame: u32) -> Result<Scene> {
        match &self.source {
            Source::Generator(table) => {
                let scene = generate::make(table, frame)?;
                Ok(Scene { name: self.id.clone(), views: self.views.clone(), ..scene })
            }
            Source::Files(files) => {
                let scene = files.load(frame)?;
                Ok(Scene { name: self.id.clone(), views: self.views.clone(), ..scene })
            }
        }
    }
}
