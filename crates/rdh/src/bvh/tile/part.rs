//! A part of a batch, as one thread casts it: in tiles where rays are coherent, sorted or by turns where they have no order, else one
//! by one.

use std::mem;

use super::sorted::{self, makes_neighbours, sorted};
use crate::bvh::Bvh;
use crate::bvh::leaves::AnyLeaves;
use crate::bvh::recent::Recent;
use crate::bvh::strands;
use crate::geom::Ray;
use crate::simd::{Job, Kernels, prefetch};
use crate::tile::{Cost, Others, OthersSlots, Packed, Tiles, are_unordered};

/// Rays, and where their answers go: as many.
pub(crate) struct Part<'a, C: Packed> {
    pub(crate) tree: &'a Bvh<8, AnyLeaves>,
    /// Casts a ray as it is cast alone, by code that knows the form of the leaves and has all registers.
    pub(crate) alone: &'a dyn Fn(&Ray, &mut C::Output),
    /// How large the structure is.
    pub(crate) bytes: usize,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [C::Output],
    /// How many rays a row has, if the rays are rows of a picture.
    pub(crate) width: Option<usize>,
}

impl<C: Packed> Job for Part<'_, C> {
    type Output = Cost;

    /// One loop, so that tiles are compiled once: all of theirs is inlined here, where the level's instructions are known.
    #[inline(always)]
    fn run<K: Kernels>(mut self) -> Cost {
        let mut sorts = self.sorts();
        let mut turns_pay = if self.tries_turns(sorts) { None } else { Some(false) };
        let mut tiles = Tiles::<K, _>::new(self.tree, self.rays.len(), self.width);
        let mut slots = OthersSlots::new();
        let mut others = Others::none(&mut slots);
        let mut done = false;
        while !done {
            let rest = tiles.rest().filter(|_| turns_pay == Some(false) && mem::take(&mut sorts));
            let all = rest.and_then(|from| sorted(self.rays, from));
            let which = match &all {
                Some(all) => &all[..],
                None => {
                    tiles.cast::<C>(self.tree, self.rays, self.answers, &mut others);
                    others.rays()
                }
            };
            self.cast_others(which, all.is_some(), &mut turns_pay);
            tiles.cast_otherwise(which.len());
            done = all.is_some() || tiles.are_done();
            others.clear();
        }
        tiles.cost()
    }
}

/// A structure up to this size stays in a core's caches or nearly: no turns.
const LARGE: usize = 2 << 20;
/// A structure beyond this size does not stay in the caches that cores share: turns come before sorting.
const HUGE: usize = 128 << 20;
/// So many rays try out whether turns pay.
const SAMPLE: usize = 256;
/// So many rays ahead memory is asked for.
const SOON: usize = 4;

impl<C: Packed> Part<'_, C> {
    /// Whether rays have no order, and are enough to be given one.
    fn sorts(&self) -> bool {
        let count = self.rays.len();
        (sorted::FEWEST..=sorted::MOST).contains(&count)
            && are_unordered(count, |i| &self.rays[i])
            && makes_neighbours(self.rays)
    }

    /// Whether it is to be tried out if turns pay.
    fn tries_turns(&self, sorts: bool) -> bool {
        self.bytes > if sorts { HUGE } else { LARGE }
    }

    /// Rays without order take turns where they wait for memory, which their first ones try out; elsewhere turns cost a quarter.
    fn cast_others(&mut self, which: &[u32], is_sorted: bool, turns_pay: &mut Option<bool>) {
        let is_unordered = *turns_pay != Some(false) && are_unordered(which.len(), |i| &self.rays[which[i] as usize]);
        let mut recent = (is_unordered && turns_pay.is_none()).then(Recent::nothing);
        let (sample, rest) = which.split_at(recent.as_ref().map_or(0, |_| SAMPLE.min(which.len())));
        for which in [sample, rest] {
            let (tree, rays, answers) = (self.tree, self.rays, &mut *self.answers);
            if is_unordered && *turns_pay != Some(false) {
                tree.level.run(ByTurns::<C> { tree, rays, which, recent: recent.as_mut(), answers });
                *turns_pay = turns_pay.or(recent.take().map(|recent| recent.waits()));
            } else {
                self.one_by_one(which, is_sorted);
            }
        }
    }

    /// Sorted rays lie here and there, and so do their answers: memory is asked for ahead.
    fn one_by_one(&mut self, which: &[u32], is_sorted: bool) {
        let ahead = if is_sorted { SOON } else { which.len() };
        for (i, &ray) in which.iter().enumerate() {
            if let Some(&soon) = which.get(i + ahead) {
                prefetch(&self.rays[soon as usize]);
                prefetch(&self.answers[soon as usize]);
            }
            let ray = ray as usize;
            (self.alone)(&self.rays[ray], &mut self.answers[ray]);
        }
    }
}

/// Some of a batch's rays, each of which waits for memory while others compute.
struct ByTurns<'a, C: Packed> {
    tree: &'a Bvh<8, AnyLeaves>,
    rays: &'a [Ray],
    which: &'a [u32],
    /// If wanted, what they visit.
    recent: Option<&'a mut Recent>,
    answers: &'a mut [C::Output],
}

impl<C: Packed> Job for ByTurns<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        let done = |ray, answer| self.answers[ray as usize] = answer;
        strands::cast::<K, C>(self.tree, self.rays, self.which, self.recent, done);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Structure;
    use crate::geom::Hit;
    use crate::leaf::Closest;
    use crate::soup::{numbers, soup};
    use crate::{BuildOptions, Spec, Training, build};

    /// Whatever the size of the structure is said to be, so that rays take turns, are sorted, or turns are tried and given up.
    #[test]
    fn rays_without_order_hit_what_they_hit_alone() {
        let mut number = numbers(1);
        // From few places, so that sorting makes neighbours.
        let place = f32::round;
        let mut rays: Vec<Ray> = (0..sorted::MOST + 1)
            .map(|_| Ray::new([number(), number(), number()].map(place), [number(), number(), number()]))
            .collect();
        rays[7].origin[0] = f32::NAN;
        rays[4000].origin = [f32::INFINITY; 3];
        rays[5000].direction = [0.0; 3];
        for triangles in [20, 30_000] {
            let spec = "bvh8+sah".parse::<Spec>().expect("a spec");
            let built = build(&soup(triangles, 0.05), &spec, &Training::none(), &BuildOptions::default());
            let accel = built.expect("it builds");
            let Structure::Bvh8(tree) = accel.structure() else { panic!("{accel:?} is no tree of eight") };
            let right: Vec<Option<Hit>> = rays.iter().map(|ray| accel.closest(ray)).collect();
            for count in [100, 1000, 5000, sorted::MOST, sorted::MOST + 1] {
                for bytes in [0, LARGE + 1, HUGE + 1] {
                    let mut answers = vec![None; count];
                    let tree = &tree.with_any_leaves();
                    let alone = &|ray: &Ray, answer: &mut Option<Hit>| *answer = accel.closest(ray);
                    let part = Part::<Closest> {
                        tree,
                        alone,
                        bytes,
                        rays: &rays[..count],
                        answers: &mut answers,
                        width: None,
                    };
                    tree.level.run(part);
                    assert_eq!(answers[..], right[..count], "{triangles} triangles, {bytes} bytes, {count} rays");
                }
            }
        }
    }
}
