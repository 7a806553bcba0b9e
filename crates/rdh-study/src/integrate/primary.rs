//! Ray casting: the primary ray alone.

use rdh::{Ray, RayClass};

use super::caster::Caster;
use super::shade::{AMBIENT, BACKGROUND, facing_cosine};
use super::stage::Stage;

/// One closest hit, lit by a lamp at the eye, so that no further ray is needed.
pub(crate) fn trace(stage: &Stage, ray: &Ray, caster: &mut impl Caster) -> f64 {
    let Some(hit) = caster.closest(ray, RayClass::Primary) else {
        return BACKGROUND;
    };
    let point = stage.surface(ray, &hit);
    AMBIENT + (1.0 - AMBIENT) * facing_cosine(&point, ray)
}
