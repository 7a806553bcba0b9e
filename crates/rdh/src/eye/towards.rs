//! Rays that end at the eye: whether they pass close enough, and what part of the picture's depth is theirs.

use super::project::Tolerance;
use super::side::Side;
use crate::geom::{Aabb, Ray, RayFrame, Vec3};
use crate::simd::Aims;

/// How far rays may pass by the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passing {
    /// Rays that start farther from the origin of coordinates are left to others.
    reach: f32,
    /// [`RayFrame::slack`] of such rays: more than all that THE triangle test rounds for them.
    slack: f64,
}

/// The part of a ray towards the eye, in nearness: see [`Shade`](crate::simd::Shade).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Approach {
    pub(super) far: f32,
    pub(super) far_surely: f32,
    pub(super) near_surely: f32,
}

impl Passing {
    /// For rays that start up to twice as far from the origin of coordinates as the scene and the eye.
    pub(super) fn new(eye: &Vec3, bounds: &Aabb) -> Self {
        let magnitude = bounds.magnitude();
        let reach = 2.0 * eye.iter().fold(magnitude, |m, x| m.max(x.abs()));
        Self { reach, slack: f64::from(RayFrame::slack([reach, 0.0, 0.0], magnitude)) }
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

    /// The part of a valid ray that lies before the eye, if it passes by it closely and ends there or before.
    pub(super) fn approach(&self, eye: &Vec3, ray: &Ray, frame: &RayFrame) -> Option<Approach> {
        let length = f64::from(frame.direction_z.abs());
        let side = Side::of(frame);
        let (origin, eye) = (frame.origin, side.along(eye));
        let nearby = origin.iter().all(|x| x.abs() <= self.reach);
        let usual = (Aims::SHORTEST..=Aims::LONGEST).contains(&frame.direction_z.abs());
        let [x, y, z] = [0, 1, 2].map(|a| f64::from(origin[a]) - f64::from(eye[a]));
        let across = [x - f64::from(frame.shear[0]) * z, y - f64::from(frame.shear[1]) * z];
        let passes = across.iter().all(|x| x.abs() <= self.slack);
        let depth = if frame.direction_z < 0.0 { z } else { -z };
        let (far, near) = (depth - f64::from(ray.t_min) * length, depth - f64::from(ray.t_max) * length);
        let slack = 4.0 * self.slack;
        if !(nearby && usual && passes && near >= -2.0 * self.slack && far > slack) {
            return None;
        }
        // The reciprocals' rounding and more.
        const LESS: f64 = 1.0 - 1e-6;
        const MORE: f64 = 1.0 + 1e-6;
        Some(Approach {
            far: (LESS / (far + slack)) as f32,
            far_surely: (MORE / (far - slack)) as f32,
            near_surely: (LESS / (near + slack)) as f32,
        })
    }
}
