//! Ambient occlusion: how much of the near surroundings is open.

use rdh::{Ray, RayClass};

use super::caster::Caster;
use super::random::Random;
use super::shade::BACKGROUND;
use super::stage::Stage;

/// Rays at each primary hit.
pub(crate) const RAYS_A_HIT: usize = 4;

/// Their length, as a part of the scene's diagonal.
pub(crate) const REACH: f32 = 0.1;

/// A primary ray, and at its hit short cosine-distributed rays that ask whether anything is near.
pub(crate) fn trace(stage: &Stage, ray: &Ray, random: &mut Random, caster: &mut impl Caster) -> f64 {
    let Some(hit) = caster.closest(ray, RayClass::Primary) else {
        return BACKGROUND;
    };
    let point = stage.surface(ray, &hit);
    let reach = stage.bounds().diagonal() * REACH;
    let mut open = 0;
    for _ in 0..RAYS_A_HIT {
        let ray = point.spawn(random.cosine_direction(point.facing)).within(0.0, reach);
        open += usize::from(!caster.occluded(&ray, RayClass::Ao));
    }
    open as f64 / RAYS_A_HIT as f64
}
