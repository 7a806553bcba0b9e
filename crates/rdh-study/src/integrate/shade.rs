//! Shading: just enough to see what is there. Colours and falloff are left out; only rays matter here.

use rdh::{Accel, Ray, RayClass, Vec3};

use super::caster::{Caster, Plain};
use super::mode::Mode;
use super::random::Random;
use super::stage::{Stage, SurfacePoint};
use super::vector::{dot, sub, unit, wide};

/// Light from everywhere.
pub(crate) const AMBIENT: f64 = 0.2;

/// What is seen where nothing is.
pub(crate) const BACKGROUND: f64 = 0.05;

/// The light that comes back along one camera ray, about 0 to 1, linear: a pixel of a picture. `seed` and `sample` name
/// the random numbers of modes that use some.
pub fn radiance(stage: &Stage, accel: &Accel, mode: Mode, ray: &Ray, seed: u64, sample: u64) -> f32 {
    mode.trace(stage, ray, &mut Random::new(seed, sample), &mut Plain(accel)) as f32
}

/// The cosine between a ray and the surface it hit.
pub(crate) fn facing_cosine(point: &SurfacePoint, ray: &Ray) -> f64 {
    unit(wide(ray.direction)).map_or(0.0, |d| -dot(d, point.facing)).max(0.0)
}

/// Lambert's cosine of a light in front of a point, 0 if a shadow ray finds something between. Lights behind cast no ray.
pub(crate) fn light_from(point: &SurfacePoint, light: Vec3, caster: &mut impl Caster) -> f64 {
    if !point.faces(light) {
        return 0.0;
    }
    match (unit(sub(wide(light), point.position)), point.spawn_to(light)) {
        (Some(towards), Some(ray)) if !caster.occluded(&ray, RayClass::Shadow) => dot(towards, point.facing).abs(),
        _ => 0.0,
    }
}
