//! What integrators cast through: the same paths give pictures, batches of rays, or profiles.

use std::collections::BTreeMap;

use rdh::{Accel, Hit, Query, Ray, RayClass, Recorder};

/// Answers an integrator's queries, and may note them.
pub(crate) trait Caster {
    fn closest(&mut self, ray: &Ray, class: RayClass) -> Option<Hit>;
    fn occluded(&mut self, ray: &Ray, class: RayClass) -> bool;
}

/// Only answers.
pub(crate) struct Plain<'a>(pub(crate) &'a Accel);

impl Caster for Plain<'_> {
    fn closest(&mut self, ray: &Ray, _class: RayClass) -> Option<Hit> {
        self.0.closest(ray)
    }

    fn occluded(&mut self, ray: &Ray, _class: RayClass) -> bool {
        self.0.occluded(ray)
    }
}

/// Keeps every ray, by class and query.
pub(crate) struct Keeping<'a> {
    pub(crate) accel: &'a Accel,
    pub(crate) rays: BTreeMap<(RayClass, Query), Vec<Ray>>,
}

impl Keeping<'_> {
    fn keep(&mut self, ray: &Ray, class: RayClass, query: Query) {
        self.rays.entry((class, query)).or_default().push(*ray);
    }
}

impl Caster for Keeping<'_> {
    fn closest(&mut self, ray: &Ray, class: RayClass) -> Option<Hit> {
        self.keep(ray, class, Query::Closest);
        self.accel.closest(ray)
    }

    fn occluded(&mut self, ray: &Ray, class: RayClass) -> bool {
        self.keep(ray, class, Query::Occluded);
        self.accel.occluded(ray)
    }
}

/// Records every ray and where it ended. An occluded ray ends at its nearest hit, which takes a closest query to find:
/// a front-to-back traversal stops in the cell of that hit.
pub(crate) struct Recording<'a> {
    pub(crate) accel: &'a Accel,
    pub(crate) recorder: &'a Recorder,
}

impl Recording<'_> {
    fn cast(&mut self, ray: &Ray, class: RayClass, query: Query) -> Option<Hit> {
        let hit = self.accel.closest(ray);
        self.recorder.record(ray, hit, query, class);
        hit
    }
}

impl Caster for Recording<'_> {
    fn closest(&mut self, ray: &Ray, class: RayClass) -> Option<Hit> {
        self.cast(ray, class, Query::Closest)
    }

    fn occluded(&mut self, ray: &Ray, class: RayClass) -> bool {
        self.cast(ray, class, Query::Occluded).is_some()
    }
}
