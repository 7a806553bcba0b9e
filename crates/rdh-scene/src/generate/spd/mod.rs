//! The Standard Procedural Databases of Eric Haines ("A Proposal for Standard Graphics Environments", IEEE CG&A 7(11),
//! 1987; package version 3.14), from their definitions: each file states its shape.
//!
//! Deviations, and why:
//! - Round things are tessellated (see [`super::round`] for the rule), so that triangle counts differ from the
//!   published primitive counts; [`Primitives`] has those. Polygons with n corners become n - 2 triangles.
//! - The package's pictures are left-handed: ours are mirrored left to right, which changes no count of rays.
//! - Colours are left out; `diffuse`, `mirror` and `transmission` are the package's Kd, Ks and T as given, which may
//!   add up to more than 1.
//! - Pictures are square, and `fov_y_degrees` is the full angle. The published view is called `given`.

mod balls;
mod gears;
mod jacks;
mod lattice;
mod mount;
mod rings;
mod shells;
mod sombrero;
mod teapot;
mod tetra;
mod tree;

pub(crate) use balls::Balls;
pub(crate) use gears::Gears;
pub(crate) use jacks::Jacks;
pub(crate) use lattice::Lattice;
pub(crate) use mount::Mount;
pub(crate) use rings::Rings;
pub(crate) use shells::Shells;
pub(crate) use sombrero::Sombrero;
pub(crate) use teapot::Teapot;
pub(crate) use tetra::Tetra;
pub(crate) use tree::Tree;

use super::round::{sphere_triangles, tube_triangles};
use crate::scene::Material;

/// How many primitives of each sort a scene of the package has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Primitives {
    pub(crate) spheres: u64,
    pub(crate) tubes: u64,
    pub(crate) triangles: u64,
    pub(crate) quads: u64,
    /// Concave polygons of 144 corners.
    pub(crate) gear_faces: u64,
}

impl Primitives {
    /// Their triangles when round things have a resolution.
    pub(crate) fn tessellated(&self, resolution: u32) -> f64 {
        (self.spheres * sphere_triangles(resolution)
            + self.tubes * tube_triangles(resolution)
            + self.triangles
            + 2 * self.quads
            + 142 * self.gear_faces) as f64
    }

    /// All of them together, as the package counts.
    #[cfg(test)]
    pub(crate) fn total(&self) -> u64 {
        self.spheres + self.tubes + self.triangles + self.quads + self.gear_faces
    }
}

/// A surface as the package describes it: Kd, Ks, T and the index of refraction.
fn surface(diffuse: f32, mirror: f32, transmission: f32, index: f32) -> Material {
    Material { diffuse, mirror, transmission, index }
}

/// A surface that lets no light through.
fn opaque(diffuse: f32, mirror: f32) -> Material {
    surface(diffuse, mirror, 0.0, 1.0)
}

const Z_UP: [f64; 3] = [0.0, 0.0, 1.0];
const Y_UP: [f64; 3] = [0.0, 1.0, 0.0];
const ORIGIN: [f64; 3] = [0.0; 3];
/// The resolution of round things unless another is asked for.
const RESOLUTION: u32 = 2;

/// The parameters of a scene whose round things are tessellated.
macro_rules! sized {
    ($(#[$doc:meta])* $name:ident, size = $size:expr, resolution = $resolution:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub(crate) struct $name {
            /// The package's size factor.
            pub(crate) size: u32,
            /// Parts of a quarter circle.
            pub(crate) resolution: u32,
        }

        impl Default for $name {
            fn default() -> Self {
                Self { size: $size, resolution: $resolution }
            }
        }
    };
    ($(#[$doc:meta])* $name:ident, size = $size:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub(crate) struct $name {
            /// The package's size factor.
            pub(crate) size: u32,
        }

        impl Default for $name {
            fn default() -> Self {
                Self { size: $size }
            }
        }
    };
}
use sized;

#[cfg(test)]
mod tests;
