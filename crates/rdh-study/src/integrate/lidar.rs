//! A spinning scanner: 64 beams at fixed elevations, 2048 firings a turn.

use rdh::{Ray, RayClass};

use super::caster::Caster;
use super::shade::{BACKGROUND, facing_cosine};
use super::stage::Stage;

/// Beams, one above the other.
pub const LIDAR_BEAMS: usize = 64;

/// Firings of all beams in one turn.
pub const LIDAR_AZIMUTHS: usize = 2048;

/// The vertical field: beam `i` of 64 has the elevation `22.5° − 45° (i + ½) / 64`, so they are 0.703° apart, between
/// +22.15° and −22.15°. Range is not limited.
pub const LIDAR_FIELD_DEGREES: f64 = 45.0;

/// One return.
pub(crate) fn trace(stage: &Stage, ray: &Ray, caster: &mut impl Caster) -> f64 {
    let Some(hit) = caster.closest(ray, RayClass::Lidar) else {
        return BACKGROUND;
    };
    facing_cosine(&stage.surface(ray, &hit), ray)
}
