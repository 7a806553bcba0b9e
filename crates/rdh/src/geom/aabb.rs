//! Axis-aligned boxes.

use super::{Axis, Vec3};

/// An axis-aligned box, closed on all sides; empty when `min > max` on some axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The lower corner.
    pub min: Vec3,
    /// The upper corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box around some points.
    pub fn around(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, &p| b.with(p))
    }

    /// This box, grown to hold a point.
    #[inline(always)]
    pub fn with(mut self, p: Vec3) -> Self {
        for (a, &x) in p.iter().enumerate() {
            self.min[a] = self.min[a].min(x);
            self.max[a] = self.max[a].max(x);
        }
        self
    }

    /// The smallest box around both, either of which may be empty.
    pub fn union(&self, other: &Self) -> Self {
        let mut out = *self;
        for a in 0..3 {
            out.min[a] = self.min[a].min(other.min[a]);
            out.max[a] = self.max[a].max(other.max[a]);
        }
        out
    }

    /// What both have in common.
    #[inline(always)]
    pub fn intersection(&self, other: &Self) -> Self {
        let mut out = *self;
        for a in 0..3 {
            out.min[a] = self.min[a].max(other.min[a]);
            out.max[a] = self.max[a].min(other.max[a]);
        }
        out
    }

    /// Whether another box lies in this one, and is none that holds nothing or has a NaN.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        (0..3).all(|a| self.min[a] <= other.min[a] && other.min[a] <= other.max[a] && other.max[a] <= self.max[a])
    }

    /// Whether it holds no point at all.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|a| self.min[a] > self.max[a])
    }

    /// The edge lengths; negative for an empty box.
    #[inline(always)]
    pub fn extent(&self) -> Vec3 {
        [0, 1, 2].map(|a| self.max[a] - self.min[a])
    }

    /// Length of the diagonal; 0 for an empty box.
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let squares: f64 = self.extent().iter().map(|&e| f64::from(e) * f64::from(e)).sum();
        squares.sqrt() as f32
    }

    /// The centre.
    pub fn centre(&self) -> Vec3 {
        [0, 1, 2].map(|a| self.min[a] * 0.5 + self.max[a] * 0.5)
    }

    /// The two boxes on either side of the plane `axis = position`.
    #[inline(always)]
    pub fn split(&self, axis: Axis, position: f32) -> (Self, Self) {
        let (mut left, mut right) = (*self, *self);
        left.max[axis.index()] = position;
        right.min[axis.index()] = position;
        (left, right)
    }

    /// The largest absolute coordinate; 0 for an empty box.
    pub fn magnitude(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        self.min.iter().chain(&self.max).fold(0.0, |m, x| x.abs().max(m))
    }

    /// The part of a line that lies in the box grown by `pad` on all sides: `t` from the first to the second number,
    /// or nothing. Exact zeros in `direction` are allowed.
    pub fn clip_line(&self, origin: Vec3, direction: Vec3, pad: f32) -> Option<(f32, f32)> {
        let (mut near, mut far) = (f32::NEG_INFINITY, f32::INFINITY);
        for a in 0..3 {
            let (lo, hi) = (self.min[a] - pad, self.max[a] + pad);
            if direction[a] == 0.0 {
                if origin[a] < lo || origin[a] > hi {
                    return None;
                }
                continue;
            }
            let (t0, t1) = ((lo - origin[a]) / direction[a], (hi - origin[a]) / direction[a]);
            near = near.max(t0.min(t1));
            far = far.min(t0.max(t1));
        }
        (near <= far).then_some((near, far))
    }
}
