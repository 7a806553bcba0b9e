//! The six sides of a cube around the eye: what lies along which axis.

use crate::geom::{RayFrame, Vec3};

/// A side: the axis along which its rays run most, and whether they run down it. The axes are those of [`RayFrame`], so that a place in
/// the side's picture is the ray's shear, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Side(u8);

impl Side {
    /// How many there are.
    pub(super) const COUNT: usize = 6;

    /// All of them, in order.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT as u8).map(Self)
    }

    /// The side of rays from the eye.
    #[inline(always)]
    pub(super) fn of(frame: &RayFrame) -> Self {
        Self(2 * frame.k[2] as u8 + u8::from(frame.direction_z < 0.0))
    }

    /// The other side of the same axis.
    #[inline(always)]
    pub(super) fn opposite(self) -> Self {
        Self(self.0 ^ 1)
    }

    /// Its number.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }

    /// Which axes become x, y and z.
    #[inline(always)]
    pub(super) fn axes(self) -> [usize; 3] {
        match self.0 / 2 {
            0 => [1, 2, 0],
            1 => [2, 0, 1],
            _ => [0, 1, 2],
        }
    }

    /// Whether its rays run down the axis.
    #[inline(always)]
    pub(super) fn is_down(self) -> bool {
        self.0 & 1 == 1
    }

    /// A point along its axes.
    #[inline(always)]
    pub(super) fn along(self, p: &Vec3) -> Vec3 {
        self.axes().map(|a| p[a])
    }
}
