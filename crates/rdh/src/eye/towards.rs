//! Rays that end at the eye: how closely they have to pass by it, and what that costs in margins.

use super::project::Tolerance;
use crate::geom::{Aabb, RayFrame, Vec3};
use crate::simd::Passing;

impl Passing {
    /// For rays that start up to twice as far from the origin of coordinates as the scene and the eye.
    pub(super) fn new(eye: Vec3, bounds: &Aabb) -> Self {
        let magnitude = bounds.magnitude();
        let reach = 2.0 * eye.iter().fold(magnitude, |m, x| m.max(x.abs()));
        Self { eye, reach, slack: f64::from(RayFrame::slack([reach, 0.0, 0.0], magnitude)) }
    }

    /// Whether products of lengths are far from f32's ends.
    pub(super) fn is_usual(&self) -> bool {
        const LARGEST: f32 = (1u64 << 60) as f32;
        (1.0 / LARGEST..=LARGEST).contains(&self.reach)
    }

    /// A ray's line passes by the eye by up to one slack, and another one is for rounding. Along the ray there are two for where it
    /// ends, one for rounding, one to spare.
    pub(super) fn tolerance(&self) -> Tolerance {
        Tolerance { across: 2.0 * self.slack, along: 4.0 * self.slack }
    }
}
