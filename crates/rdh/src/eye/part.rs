//! A part of a batch, as one thread casts it: runs of rays that are the eye's walk together, all others are the other structure's.

use super::EyeTree;
use super::spec::EyeForm;
use super::{shadow, tile};
use crate::geom::{Hit, Ray};

/// Fewer rays of a kind in a row go one by one: others may make something of more.
const FEWEST: usize = 16;
/// Rays of which three tell whether they are towards the eye.
const GROUP: usize = 64;

impl EyeTree {
    /// The nearest hit of each ray; `width` is how many rays a row has, if they are whole rows of a picture.
    pub(crate) fn closest_part(&self, rays: &[Ray], hits: &mut [Option<Hit>], width: Option<usize>) {
        let mut from = 0;
        for run in rays.chunk_by(|a, b| self.starts_at_eye(a) == self.starts_at_eye(b)) {
            let hits = &mut hits[from..from + run.len()];
            let width = width.filter(|_| run.len() == rays.len());
            from += run.len();
            if run.len() < FEWEST {
                run.iter().zip(hits).for_each(|(ray, hit)| *hit = self.closest(ray));
            } else if self.starts_at_eye(&run[0]) {
                self.level.run(tile::Closest { tree: self, rays: run, width, hits });
            } else {
                self.world.closest_part(run, hits, width);
            }
        }
    }

    /// Whether each ray hits anything.
    pub(crate) fn occluded_part(&self, rays: &[Ray], found: &mut [bool], width: Option<usize>) {
        let mut from = 0;
        while from < rays.len() {
            let is_for = self.is_for(first_group(&rays[from..]));
            let mut to = from;
            while to < rays.len() && self.is_for(first_group(&rays[to..])) == is_for {
                to = (to + GROUP).min(rays.len());
            }
            let (run, found) = (&rays[from..to], &mut found[from..to]);
            if is_for {
                self.level.run(shadow::Occluded { tree: self, rays: run, found });
            } else {
                self.world.occluded_part(run, found, width.filter(|_| run.len() == rays.len()));
            }
            from = to;
        }
    }

    /// Whether a ray starts at the eye, bit for bit: that of −0 and 0 would make zeros of other signs.
    #[inline(always)]
    pub(super) fn starts_at_eye(&self, ray: &Ray) -> bool {
        ray.origin.map(f32::to_bits) == self.eye.map(f32::to_bits)
    }

    /// Whether some rays are probably the eye's, by the first, the last and one in between.
    fn is_for(&self, group: &[Ray]) -> bool {
        let last = group.len() - 1;
        [0, last / 2, last].iter().any(|&i| {
            let ray = &group[i];
            self.starts_at_eye(ray) || self.form == EyeForm::Towards && self.approaching(ray).is_some()
        })
    }
}

fn first_group(rays: &[Ray]) -> &[Ray] {
    &rays[..rays.len().min(GROUP)]
}
