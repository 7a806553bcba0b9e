//! What the rays of one path cost: a pixel of a heat map.

use rdh::{Accel, Counts, Hit, Ray, RayClass};

use super::caster::Caster;
use super::mode::Mode;
use super::random::Random;
use super::stage::Stage;

/// What all rays of the path that starts with `ray` cost together. `seed` and `sample` name the random numbers of modes that
/// use some: with the same ones every structure casts the same rays.
pub fn path_counts(stage: &Stage, accel: &Accel, mode: Mode, ray: &Ray, seed: u64, sample: u64) -> Counts {
    let mut counting = Counting { accel, counts: Counts::default() };
    mode.trace(stage, ray, &mut Random::new(seed, sample), &mut counting);
    counting.counts
}

struct Counting<'a> {
    accel: &'a Accel,
    counts: Counts,
}

impl Caster for Counting<'_> {
    fn closest(&mut self, ray: &Ray, _class: RayClass) -> Option<Hit> {
        self.accel.closest_counted(ray, &mut self.counts)
    }

    fn occluded(&mut self, ray: &Ray, _class: RayClass) -> bool {
        self.accel.occluded_counted(ray, &mut self.counts)
    }
}
