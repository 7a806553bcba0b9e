//! Diffuse paths: all surfaces scatter by the cosine, each hit casts one shadow ray to one light (next-event estimation),
//! and paths end after four bounces or in the background, never by roulette.

use rdh::{Ray, RayClass};

use super::caster::Caster;
use super::random::Random;
use super::shade::{BACKGROUND, light_from};
use super::stage::Stage;

/// Directions chosen after the primary hit.
pub(crate) const BOUNCES: usize = 4;

/// One path. A mirror's whole reflectance counts as diffuse: this mode is about diffuse rays.
pub(crate) fn trace(stage: &Stage, ray: &Ray, random: &mut Random, caster: &mut impl Caster) -> f64 {
    let (mut radiance, mut weight) = (0.0, 1.0);
    let (mut ray, mut class) = (*ray, RayClass::Primary);
    for bounce in 0..=BOUNCES {
        let Some(hit) = caster.closest(&ray, class) else {
            return radiance + weight * BACKGROUND;
        };
        let point = stage.surface(&ray, &hit);
        let material = point.material;
        weight *= f64::from(material.diffuse + material.mirror + material.transmission).min(1.0);
        let light = stage.lights()[random.below(stage.lights().len())];
        radiance += weight * light_from(&point, light, caster);
        if bounce < BOUNCES {
            ray = point.spawn(random.cosine_direction(point.facing));
            class = RayClass::Bounce;
        }
    }
    radiance
}
