//! Rays in an order in which an application might cast them, dealt into blocks, which statistics are over.
//!
//! A sample has no order, and structures that are timed on shuffled rays differ less than they do in use. So the rays of a class
//! are sorted by where they start, and those that start together by direction: as in tiles of a film, or along a surface, with
//! directions as chance has it. They are cast in this order, in short runs, and the runs are dealt out one after the other, so that
//! each block is a fair sample of everything. A sample that stands for several rays is cast more often than others, in one run:
//! what is certain about it is certain only once.

use super::interval::LEAST_BLOCKS;
use crate::geom::{Aabb, Ray};
use crate::rays::{Query, RayClass, RaySample};

/// Rays by class and query, in blocks.
#[derive(Debug)]
pub(super) struct Deck {
    pub(super) groups: Vec<Group>,
    /// How many blocks each group has; odd, so that the degrees of freedom are even.
    pub(super) blocks: usize,
    /// Samples that can't be cast, or count nothing.
    pub(super) dropped: usize,
    /// As many equal rays would say as much: (sum of weights)² / sum of squares.
    pub(super) effective: f64,
}

/// The rays of one class and query.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) class: RayClass,
    pub(super) query: Query,
    /// Distinct rays.
    pub(super) samples: usize,
    /// How many rays each cast one stands for, times what its class counts.
    pub(super) factor: f64,
    /// In the order in which they are cast; run `i` belongs to block `i` modulo the number of blocks.
    pub(super) runs: Vec<Vec<Ray>>,
}

/// With fewer rays nothing is sure.
const LEAST_RAYS: usize = 256;
/// So many distinct rays a block, if there are enough.
const BLOCK_RAYS: usize = 256;
/// Rays of a run at most. A run is long enough to fill caches, and short enough for whatever disturbs a machine to last longer.
const RUN_RAYS: usize = 512;
/// More blocks say nothing more.
const MOST_BLOCKS: usize = 33;

impl Deck {
    pub(super) fn deal(samples: &[RaySample], class_weights: &[f64; 8]) -> Self {
        let counts = |s: &&RaySample| s.weight > 0 && class_weights[s.class as usize] > 0.0 && s.fault().is_none();
        let good: Vec<&RaySample> = samples.iter().filter(counts).collect();
        let dropped = samples.len() - good.len();
        let distinct = distinct(good);
        let good: Vec<&RaySample> = distinct.iter().collect();
        let kinds = RayClass::ALL.into_iter().flat_map(|class| Query::ALL.map(|query| (class, query)));
        let of =
            |(class, query)| good.iter().copied().filter(|s| (s.class, s.query) == (class, query)).collect::<Vec<_>>();
        let parts: Vec<Vec<&RaySample>> = kinds.map(of).filter(|part| !part.is_empty()).collect();
        let blocks = blocks(good.len());
        let groups =
            parts.iter().map(|part| Group::deal(part, class_weights[part[0].class as usize], blocks)).collect();
        Self { groups, blocks, dropped, effective: effective(&good, class_weights) }
    }

    /// Distinct rays.
    pub(super) fn samples(&self) -> usize {
        self.groups.iter().map(|g| g.samples).sum()
    }

    /// The weight of all rays that are cast: what totals are divided by.
    pub(super) fn weight(&self) -> f64 {
        self.groups.iter().map(|g| g.factor * g.rays() as f64).sum()
    }

    /// Why nothing can be decided by these rays, if so.
    pub(super) fn too_few(&self, which: &str) -> Option<String> {
        let (samples, effective) = (self.samples(), self.effective);
        let dropped = if self.dropped > 0 { format!(" ({} were of no use)", self.dropped) } else { String::new() };
        match samples {
            0..LEAST_RAYS => Some(format!("too few {which} rays: {samples}{dropped}, and {LEAST_RAYS} are needed")),
            _ if effective < LEAST_RAYS as f64 / 2.0 => Some(format!(
                "too few {which} rays: a few stand for most, so that {samples} say no more than {effective:.0} equal ones would"
            )),
            _ => None,
        }
    }
}

impl Group {
    fn deal(part: &[&RaySample], class_weight: f64, blocks: usize) -> Self {
        let total: f64 = part.iter().map(|s| f64::from(s.weight)).sum();
        let step = total / part.len() as f64;
        // A stratified sample by weight: one cast for each step of the weights' sum, at a place that changes from step to step, so that
        // it falls in with no pattern of the weights; as many in all as there are samples.
        let (mut sum, mut casts) = (0.0, 0u32);
        let mut copies = |sample: &RaySample| {
            sum += f64::from(sample.weight);
            let before = casts;
            while (f64::from(casts) + within_step(casts)) * step < sum {
                casts += 1;
            }
            (casts - before) as usize
        };
        let run = part.len().div_ceil(blocks * part.len().div_ceil(blocks * RUN_RAYS));
        let cast = |run: &[&RaySample]| run.iter().flat_map(|s| std::iter::repeat_n(s.ray, copies(s))).collect();
        let runs: Vec<Vec<Ray>> = in_order(part).chunks(run).map(cast).collect();
        let rays: usize = runs.iter().map(Vec::len).sum();
        let factor = class_weight * total / rays.max(1) as f64;
        Self { class: part[0].class, query: part[0].query, samples: part.len(), factor, runs }
    }

    /// How many rays are cast.
    pub(super) fn rays(&self) -> usize {
        self.runs.iter().map(Vec::len).sum()
    }
}

/// Equal rays as one that stands for all of them: what is certain about it is certain only once. A [`Profile`](crate::Profile) holds
/// no others, but sets may come from elsewhere.
fn distinct(mut samples: Vec<&RaySample>) -> Vec<RaySample> {
    samples.sort_by_key(|sample| sample.identity());
    let one = |equal: &[&RaySample]| {
        let weight = equal.iter().fold(0u32, |sum, sample| sum.saturating_add(sample.weight));
        RaySample { weight, ..*equal[0] }
    };
    samples.chunk_by(|a, b| a.identity() == b.identity()).map(one).collect()
}

/// A place in a step, from 0 to 1, without a pattern: the finaliser of a common hash (MurmurHash3).
fn within_step(step: u32) -> f64 {
    let mut x = step.wrapping_add(1);
    x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    f64::from(x ^ x >> 16) / 4_294_967_296.0
}

/// Those that start near each other side by side, those that start together by direction: both along a Z curve.
fn in_order<'s>(part: &[&'s RaySample]) -> Vec<&'s RaySample> {
    let bounds = part.iter().fold(Aabb::EMPTY, |b, s| b.with(s.ray.origin));
    let key = |s: &RaySample| {
        let d = s.ray.direction;
        let longest = d.iter().fold(0.0f32, |m, x| m.max(x.abs()));
        let place = |a: usize| (s.ray.origin[a] - bounds.min[a]) / (bounds.max[a] - bounds.min[a]);
        (z_curve([0, 1, 2].map(place)), z_curve(d.map(|x| 0.5 + 0.5 * x / longest)))
    };
    let mut ordered: Vec<_> = part.iter().map(|&s| (key(s), s)).collect();
    ordered.sort_by_key(|(key, _)| *key);
    ordered.into_iter().map(|(_, s)| s).collect()
}

/// The place along a Z curve of a point from 0 to 1, in 2¹⁰ steps an axis; NaN counts as 0.
fn z_curve(point: [f32; 3]) -> u32 {
    let spread = |x: f32| {
        let steps = (x * 1023.0) as u32;
        (0..10).fold(0, |code, bit| code | (steps.min(1023) >> bit & 1) << (3 * bit))
    };
    spread(point[0]) | spread(point[1]) << 1 | spread(point[2]) << 2
}

/// An odd number of blocks.
fn blocks(samples: usize) -> usize {
    (samples / BLOCK_RAYS).clamp(LEAST_BLOCKS, MOST_BLOCKS) | 1
}

fn effective(samples: &[&RaySample], class_weights: &[f64; 8]) -> f64 {
    let weights = samples.iter().map(|s| f64::from(s.weight) * class_weights[s.class as usize]);
    let (sum, squares) = weights.fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(i: usize, weight: u32) -> RaySample {
        let ray = Ray::new([i as f32, 0.0, 0.0], [0.0, 0.0, 1.0]);
        RaySample { weight, ..RaySample::new(ray, None, Query::Closest, RayClass::ALL[i % 2]) }
    }

    #[test]
    fn every_block_has_its_share_of_every_class() {
        let samples: Vec<_> = (0..3000).map(|i| sample(i, 1)).collect();
        let deck = Deck::deal(&samples, &[1.0; 8]);
        assert_eq!((deck.groups.len(), deck.blocks, deck.samples(), deck.weight()), (2, 11, 3000, 3000.0));
        for group in &deck.groups {
            let of = |b: usize| group.runs.iter().skip(b).step_by(deck.blocks).map(Vec::len).sum::<usize>();
            assert!(
                (0..deck.blocks).all(|b| (125..=140).contains(&of(b))),
                "{:?}",
                (0..11).map(of).collect::<Vec<_>>()
            );
        }
        assert_eq!(deck.effective, 3000.0);
    }

    #[test]
    fn rays_of_neighbouring_pixels_and_points_are_cast_one_after_the_other() {
        let way = |rays: &[Ray], at: fn(&Ray) -> [f32; 3]| {
            let apart = |w: &[Ray]| (0..3).map(|a| (at(&w[0])[a] - at(&w[1])[a]).abs()).sum::<f32>();
            rays.windows(2).map(apart).sum::<f32>() / rays.len() as f32
        };
        let at =
            |i: u32| [i.wrapping_mul(0x9e37_79b9) >> 16, i.wrapping_mul(0x85eb_ca6b) >> 16].map(|x| x as f32 / 65536.0);
        let sample =
            |origin, direction| RaySample::new(Ray::new(origin, direction), None, Query::Closest, RayClass::Primary);
        let film: Vec<_> = (0..4096).map(|i| sample([1.0; 3], [at(i)[0] - 0.5, at(i)[1] - 0.5, 1.0])).collect();
        let ground: Vec<_> = (0..4096).map(|i| sample([at(i)[0], at(i)[1], 0.0], [at(9 * i)[0], 0.1, 1.0])).collect();
        // Random neighbours are two thirds apart, sorted ones about 1/64.
        for (samples, place) in [(film, (|r| r.direction) as fn(&Ray) -> [f32; 3]), (ground, |r| r.origin)] {
            let deck = Deck::deal(&samples, &[1.0; 8]);
            assert!(way(&deck.groups[0].runs.concat(), place) < 0.06);
            assert_eq!(deck.groups[0].rays(), 4096);
        }
    }

    #[test]
    fn weights_decide_how_often_a_ray_is_cast_and_what_it_counts() {
        // Heavy ones here and there, without a period that the systematic sample could fall in with.
        let weight = |i: usize| 1 + 3 * ((i as u32).wrapping_mul(2_654_435_761) >> 31);
        let samples: Vec<_> = (0..1000).map(|i| sample(2 * i, weight(i))).collect();
        let total: u32 = samples.iter().map(|s| s.weight).sum();
        let share = samples.iter().filter(|s| s.weight == 4).map(|s| s.weight).sum::<u32>() as f64 / f64::from(total);
        let deck = Deck::deal(&samples, &[2.0; 8]);
        let group = &deck.groups[0];
        let heavy = group.runs.iter().flatten().filter(|r| weight(r.origin[0] as usize / 2) == 4).count();
        assert!((heavy as f64 / group.rays() as f64 - share).abs() < 0.03, "{heavy} of {}, {share}", group.rays());
        assert!((990..=1010).contains(&group.rays()) && (deck.weight() - 2.0 * f64::from(total)).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_cast_is_dropped_and_one_heavy_ray_is_one_ray() {
        let mut samples: Vec<_> = (0..600).map(|i| sample(i, 1)).collect();
        samples[5].ray.origin[1] = f32::NAN;
        samples[6].ray.direction = [0.0; 3];
        samples[7].weight = 0;
        assert_eq!(Deck::deal(&samples, &[1.0; 8]).dropped, 3);
        assert!(Deck::deal(&samples, &[1.0; 8]).too_few("held-out").is_none());
        samples[0].weight = u32::MAX;
        let deck = Deck::deal(&samples, &[1.0; 8]);
        assert!(deck.effective < 1.001 && deck.too_few("held-out").unwrap().contains("1 equal"));
        let often = Deck::deal(&[sample(1, 2); 5000], &[1.0; 8]);
        assert_eq!((often.samples(), often.weight(), often.dropped), (1, 10_000.0, 0));
        assert!(often.too_few("held-out").unwrap().contains("held-out rays: 1,"));
        let none = Deck::deal(&[], &[1.0; 8]);
        assert!(none.too_few("training").unwrap().contains("training rays: 0,"));
        assert_eq!((none.weight(), none.effective), (0.0, 0.0));
    }
}
