//! The vocabulary: boxes, rays, hits, and THE triangle test, one formula for every structure.

mod aabb;
mod plane;
mod ray;
mod triangle;

pub use aabb::Aabb;
pub use plane::{PlaneFrame, Scale};
pub use ray::{GeomId, Hit, InstId, Ray, TriId};
pub use triangle::{RayFrame, owns_crossing};
pub(crate) use triangle::{crossing, hit_sheared, hit_triangle, larger, smaller};

/// A point or a direction. Plain arrays, so that no vector library binds the users.
pub type Vec3 = [f32; 3];

/// One of the three coordinate axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Axis {
    /// The first coordinate.
    X = 0,
    /// The second coordinate.
    Y = 1,
    /// The third coordinate.
    Z = 2,
}

impl Axis {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    #[inline(always)]
    pub const fn index(self) -> usize {
        self as usize
    }
}
