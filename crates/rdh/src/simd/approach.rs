//! Rays that end at an eye: whether they pass by it closely enough, and what part of the picture's depth is theirs.

use super::Aims;
use super::sight::{RAYS, Shade};
use crate::geom::{Ray, RayFrame, Vec3};

/// The eye, and how far rays may pass by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passing {
    pub(crate) eye: Vec3,
    /// Rays that start farther from the origin of coordinates are left to others.
    pub(crate) reach: f32,
    /// [`RayFrame::slack`] of such rays: more than all that THE triangle test rounds for them.
    pub(crate) slack: f64,
}

/// The part of a ray towards the eye, in nearness: see [`Shade`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approach {
    pub(crate) far: f32,
    pub(crate) far_surely: f32,
    pub(crate) near_surely: f32,
}

/// Less than a reciprocal by more than its rounding, …
pub(super) const LESS: f64 = 1.0 - 1e-6;
/// … and more.
pub(super) const MORE: f64 = 1.0 + 1e-6;

impl Passing {
    /// The part of a valid ray that lies before the eye, if it passes by it closely and ends there or before.
    #[inline(always)]
    pub(crate) fn approach(&self, frame: &RayFrame) -> Option<Approach> {
        let length = f64::from(frame.direction_z.abs());
        let (origin, eye) = (frame.origin, frame.k.map(|a| self.eye[a]));
        let nearby = origin.iter().all(|x| x.abs() <= self.reach);
        let usual = (Aims::SHORTEST..=Aims::LONGEST).contains(&frame.direction_z.abs());
        let [x, y, z] = [0, 1, 2].map(|a| f64::from(origin[a]) - f64::from(eye[a]));
        let across = [x - f64::from(frame.shear[0]) * z, y - f64::from(frame.shear[1]) * z];
        let passes = across.iter().all(|x| x.abs() <= self.slack);
        let depth = if frame.direction_z < 0.0 { z } else { -z };
        let (far, near) = (depth - f64::from(frame.t_min) * length, depth - f64::from(frame.t_max) * length);
        let slack = 4.0 * self.slack;
        if !(nearby && usual && passes && near >= -2.0 * self.slack && far > slack) {
            return None;
        }
        Some(Approach {
            far: (LESS / (far + slack)) as f32,
            far_surely: (MORE / (far - slack)) as f32,
            near_surely: (LESS / (near + slack)) as f32,
        })
    }
}

/// Makes eight rays ready that end at the eye: as seen from there, in the picture of the side that each comes from.
#[inline(always)]
pub(super) fn approach(rays: &[Ray; RAYS], passing: &Passing, shade: &mut Shade) -> [u32; RAYS] {
    *shade = Shade::DONE;
    let mut sides = [Aims::STRAY; RAYS];
    for (i, ray) in rays.iter().enumerate() {
        let frame = RayFrame::new(ray);
        let Some(approach) = ray.is_valid().then(|| passing.approach(&frame)).flatten() else { continue };
        // Opposite to that which it runs to.
        sides[i] = 2 * frame.k[2] as u32 + u32::from(frame.direction_z >= 0.0);
        [shade.u[i], shade.v[i]] = frame.shear;
        shade.far[i] = approach.far;
        (shade.far_surely[i], shade.near_surely[i]) = (approach.far_surely, approach.near_surely);
    }
    sides
}
