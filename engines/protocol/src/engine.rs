//! What a competitor has to provide.

use anyhow::{Result, bail};

use crate::clock::process_nanos;
use crate::files::Mesh;

/// A competitor that holds a mesh, and casts rays through it on one thread.
pub trait Engine: Sized {
    /// Its name.
    const NAME: &'static str;

    /// Builds its structure on one thread; `mode` is one of its own names, as the driver's registration has them.
    ///
    /// # Errors
    /// [`Absent`] where it can't be had on this machine; an unknown mode; whatever else goes wrong.
    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>>;

    /// The distance of the nearest hit; infinite for a miss.
    fn closest(&self, ray: &Ray) -> f32;

    /// Whether anything is hit.
    fn occluded(&self, ray: &Ray) -> bool;

    /// Casts rays in packets, and shows each one's answer in turn: a distance, or anything finite for an occlusion;
    /// infinite for a miss.
    ///
    /// # Errors
    /// It has none.
    fn packets(&self, rays: &[Ray], query: Query, see: impl FnMut(f32)) -> Result<()> {
        let _ = (rays, query, see);
        bail!("{} has no packets", Self::NAME)
    }
}

/// A ray as it stands in a file: origin, direction, and the interval of `t`, in units of the direction's length.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
    /// The first `t` that counts.
    pub t_min: f32,
    /// The last `t` that counts; may be infinite.
    pub t_max: f32,
}

/// What is asked of rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Query {
    /// The nearest hit.
    Closest,
    /// Whether anything is hit.
    Occluded,
}

/// A finished structure, and what is to be said of it.
#[derive(Debug)]
pub struct Built<E> {
    /// The structure.
    pub engine: E,
    /// The competitor's version.
    pub version: String,
    /// CPU time of the build, all threads.
    pub build_nanos: u64,
    /// Bytes of the structure, and of the triangles that it needs to trace.
    pub bytes: u64,
}

impl<E> Built<E> {
    /// Times a build. The competitor's own form of the triangles is to be made before: it is what an application has.
    pub fn time(version: &str, build: impl FnOnce() -> E, bytes: impl FnOnce(&E) -> usize) -> Self {
        let start = process_nanos();
        let engine = build();
        let build_nanos = process_nanos() - start;
        let bytes = bytes(&engine) as u64;
        Self { engine, version: version.to_owned(), build_nanos, bytes }
    }
}

/// The competitor can't be had on this machine, which is no failure: it is skipped.
#[derive(Debug)]
pub struct Absent(pub String);

impl std::fmt::Display for Absent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Absent {}
