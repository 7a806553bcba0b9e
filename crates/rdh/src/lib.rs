//! Profile-guided ray tracing.
//!
//! ```text
//!  Recorder -> Profile -> Training ----.
//!                    \--> HeldOut --.   v
//!                     \-> Unseen     \  build(&mesh, &spec, &training, &options) -> Accel -> closest, occluded, all_hits
//!                                     `-> tune(&mesh, &candidates, …): the best of many, never worse than without rays
//! ```
//! Acceleration structures are usually built by the surface area heuristic (SAH), which assumes that rays are spread evenly
//! and never hit anything. The ray distribution heuristic (RDH; Bittner and Havran, SCCG 2009) asks a sample of the
//! rays that are really cast instead. This crate builds kd-trees by both, and traces them watertight.

pub mod accel;
mod batch;
mod build;
pub mod bvh;
mod clip;
pub mod error;
pub mod eye;
pub mod fault;
pub mod geom;
pub mod heuristic;
pub mod kd;
pub mod lazy;
mod leaf;
mod mem;
pub mod mesh;
pub mod naive;
pub mod options;
mod parts;
pub mod precise;
pub mod probe;
mod radix;
pub mod rays;
pub mod sanitised;
pub mod saved;
pub mod simd;
#[cfg(test)]
mod soup;
pub mod spec;
mod surface;
mod tile;
pub mod tune;
#[cfg(feature = "twin")]
#[doc(hidden)]
#[cfg_attr(not(target_arch = "x86_64"), path = "no_twin.rs")]
pub mod twin;

pub use accel::{Accel, Provenance, Stats};
pub use build::build;
pub use error::{Error, Result};
pub use geom::{Aabb, Axis, GeomId, Hit, InstId, Ray, TriId, Vec3};
pub use heuristic::{HeuristicSpec, RdhSpec};
pub use kd::KdSpec;
pub use mesh::Mesh;
pub use options::BuildOptions;
pub use probe::{Counts, Probe};
pub use rays::{Drift, HeldOut, Profile, Query, RayClass, RaySample, Recorder, Training, Unseen};
pub use spec::{Spec, StructureSpec};
pub use tune::{TuneOptions, Tuned, tune};

/// What fuzz targets look at beyond what users see.
#[cfg(fuzzing)]
pub mod fuzzing {
    use crate::geom::{Aabb, Axis, Vec3};

    /// The boxes of a triangle's parts on both sides of a plane.
    pub fn split_triangle(corners: &[Vec3; 3], axis: Axis, plane: f32) -> (Aabb, Aabb) {
        crate::clip::split_triangle(corners, axis, plane)
    }
}

/// The README's example, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
