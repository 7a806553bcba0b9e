//! Rays through one point: kd-trees in the perspective space of an eye, for cameras, scanners and lights.
//!
//! All rays of a camera, of a scanner's pose, or of the shadows of a point light meet in one point. Divided by the depth they are parallel:
//! each is a place in a picture, and every triangle is a triangle there. A tree that is built in this space knows before which cells
//! a ray lies without walking through others, what covers what, and, by its edge functions, which linear forms tell what is hit:
//! ```text
//! project   a triangle -> linear forms over (u, v), with margins                                     once, for each side it is seen from
//! grow      a picture  -> cells, each with its triangles, nearest first; what is hidden is left out          (RDH with footprints)
//! trace     a ray      -> its cell -> candidates -> THE triangle test, with the ray as it is
//! tile      64 rays    -> the cells they meet, each triangle against eight rays at once
//! ```
//! The pictures are those of the six sides of a cube around the eye. What is found is what brute force finds, bit for bit: margins say
//! where the forms decide, and elsewhere THE triangle test does. Rays that have nothing to do with the eye are answered by another
//! structure. A tree becomes an [`Accel`] by `into`, and `kd(eye=1,2,3)+sah` is a spec ([`EyeSpec`]): then everything that takes a structure
//! takes it, and batches are cast on all threads, those of others by what the other structure has for them; so are those from the eye where
//! a sample of them costs less there, as with triangles smaller than what is between two rays.
//!
//! Related: Hunt and Mark, *Ray-Specialized Acceleration Structures for Ray Tracing* (2008), which builds grids in perspective space;
//! Bittner and Havran (SCCG 2009) for counting rays; the footprint is ours.

mod around;
mod build;
mod cell;
mod check;
mod effort;
mod face;
mod grow;
mod named;
mod part;
mod project;
mod rays;
mod shadow;
mod side;
mod spec;
mod split;
mod tile;
mod towards;
mod trace;
mod viewer;
mod walk;

pub(crate) use around::Around;
pub use spec::{EyeForm, EyeOptions, EyeSpec};

use face::Face;
use side::Side;

use crate::accel::Accel;
use crate::batch;
use crate::geom::{Hit, Ray, Vec3};
use crate::mem::Array;
use crate::simd::{Level, Passing};

/// Trees around an eye, and a structure for all other rays.
#[derive(Debug, Clone)]
pub struct EyeTree {
    form: EyeForm,
    /// The eye, too.
    passing: Passing,
    /// None where no ray was sampled.
    faces: [Option<Face>; Side::COUNT],
    masks: Option<Array<u32>>,
    world: Accel,
    level: Level,
    trained_on: usize,
}

/// What was built.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct EyeStats {
    /// Sides with a tree.
    pub sides: usize,
    /// Interior nodes and leaves.
    pub nodes: usize,
    /// References from leaves to triangles.
    pub references: usize,
    /// Triangles that some leaf names, side by side.
    pub triangles: usize,
    /// Bytes of the trees, without the structure for all other rays.
    pub bytes: usize,
    /// Training rays they were built for.
    pub trained_on: usize,
}

impl EyeTree {
    /// The nearest hit of each ray, as [`Self::closest`] finds it; fast for rays from the eye of which each 64 in a row are neighbours,
    /// and for rows of pictures, whose width is seen from the rays. Works on all threads of rayon's current pool.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn closest_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        batch::cast(rays, hits, |ray| self.closest(ray), |rays, hits, width| self.closest_part(rays, hits, width));
    }

    /// [`Self::closest_many`] for rays that come in rows of `width`, as pictures and scanners have them: neighbours in both directions
    /// walk together. The last row may be shorter.
    ///
    /// # Panics
    /// If there are not as many hits as rays, or `width` is 0.
    pub fn closest_rows(&self, rays: &[Ray], width: usize, hits: &mut [Option<Hit>]) {
        batch::cast_rows(rays, hits, width, |rays, hits, width| self.closest_part(rays, hits, width));
    }

    /// Whether each ray hits anything, as [`Self::occluded`] says; fast for rays towards the eye of which each 64 in a row are neighbours.
    /// Works on all threads of rayon's current pool.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    pub fn occluded_many(&self, rays: &[Ray], found: &mut [bool]) {
        batch::cast(rays, found, |ray| self.occluded(ray), |rays, found, width| self.occluded_part(rays, found, width));
    }

    /// The eye.
    pub fn eye(&self) -> Vec3 {
        self.passing.eye
    }

    /// The structure that answers all other rays.
    pub fn world(&self) -> &Accel {
        &self.world
    }

    /// What was built.
    pub fn stats(&self) -> EyeStats {
        let faces = self.faces.iter().flatten();
        let sum = |count: fn(&Face) -> usize| faces.clone().map(count).sum();
        EyeStats {
            sides: faces.clone().count(),
            nodes: sum(|f| 2 * f.pairs.len() + 1),
            references: sum(|f| f.entries.len()),
            triangles: sum(|f| f.sights.len()),
            bytes: self.bytes(),
            trained_on: self.trained_on,
        }
    }

    /// The trees' arrays as a number: equal for equal trees.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        for face in self.faces.iter().flatten() {
            hash.update(&[face.side.index() as u8]);
            hash.update(bytemuck::bytes_of(&face.root));
            hash.update(bytemuck::cast_slice(&face.pairs));
            hash.update(bytemuck::cast_slice(&face.entries));
            hash.update(bytemuck::cast_slice(&face.sights));
        }
        hash.digest()
    }

    /// Bytes of the trees, without the structure for all other rays.
    fn bytes(&self) -> usize {
        self.faces.iter().flatten().map(Face::bytes).sum()
    }

    /// The same, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        Self { world: self.world.with_level(level), level, ..self }
    }
}
