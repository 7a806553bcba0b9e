//! A box as eight floats, so that a union is one lane-wise minimum: the lower corner, and the upper one negated.
//!
//! Lanes 3 and 7 carry what a record needs beside its box; they take part in no comparison that matters.

use crate::geom::{Aabb, Vec3};
use crate::simd::Kernels;

/// A box with two words of payload: 32 bytes, one vector.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Extent {
    /// The lower corner.
    pub(crate) min: Vec3,
    /// A primitive's id, or a node's link.
    pub(crate) link: u32,
    /// The upper corner, negated.
    pub(crate) negated_max: Vec3,
    /// How many primitives.
    pub(crate) count: u32,
}

impl Extent {
    /// Holds nothing.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], link: 0, negated_max: [f32::INFINITY; 3], count: 0 };

    /// A box with its payload. Zeros lose their sign: else which one a union keeps would depend on the order of its boxes.
    #[inline(always)]
    pub(crate) fn new(bounds: &Aabb, link: u32, count: u32) -> Self {
        Self { min: bounds.min.map(|x| x + 0.0), link, negated_max: bounds.max.map(|x| 0.0 - x), count }
    }

    /// The box.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> Aabb {
        Aabb { min: self.min, max: self.negated_max.map(|x| -x) }
    }

    /// Grows to hold another box as well; the payload becomes meaningless.
    #[inline(always)]
    pub(crate) fn grow<K: Kernels>(&mut self, other: &Self) {
        K::lower(bytemuck::cast_mut(self), bytemuck::cast_ref(other));
    }

    /// Half of the box's surface. That of an empty box, infinite or no number, means nothing.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|a| -self.negated_max[a] - self.min[a]);
        x * y + y * z + z * x
    }

    /// Whether it holds no point at all.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        (0..3).any(|a| self.min[a] > -self.negated_max[a])
    }

    /// Twice the centre.
    #[inline(always)]
    pub(crate) fn doubled_centre(&self) -> Vec3 {
        [self.min[0] - self.negated_max[0], self.min[1] - self.negated_max[1], self.min[2] - self.negated_max[2]]
    }

    /// The same box with another payload.
    #[inline(always)]
    pub(crate) fn with(self, link: u32, count: u32) -> Self {
        Self { link, count, ..self }
    }
}
