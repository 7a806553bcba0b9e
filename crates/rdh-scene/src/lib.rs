//! Scenes for rdh: meshes from files, procedural scenes, cameras and named views.

pub mod camera;
pub mod catalog;
pub mod error;
pub mod files;
pub mod formats;
pub mod generate;
pub mod index;
pub mod path;
pub mod saved;
pub mod scene;

pub use camera::{Camera, View};
pub use catalog::{Entry, Source};
pub use error::{Error, Result};
pub use path::CameraPath;
pub use scene::{Flat, Geometry, Instance, Kind, Material, Note, PointLight, Scene, Transform};
