//! What every competitor's program does alike: it reads a mesh, builds, and answers requests to cast files of rays.
//!
//! ```text
//!  serve      requests and answers, by line
//!  cast       the timed loop, and the one that keeps each ray's answer
//!  engine     what a competitor has to provide
//!  options    the command line
//!  files      meshes, rays and answers
//!  triangle   a triangle test, for competitors without one
//!  clock      CPU time
//!  memory     how much of it is in use
//! ```
//! A program's `main` is `rdh_engine_protocol::serve::<MyEngine>()`. `engines/README.md` says how the lines look.

mod cast;
pub mod clock;
mod engine;
mod files;
pub mod memory;
mod options;
mod serve;
mod triangle;

pub use engine::{Absent, Built, Engine, Query, Ray};
pub use files::Mesh;
pub use options::Options;
pub use serve::serve;
pub use triangle::Triangle;
