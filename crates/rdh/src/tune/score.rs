//! What structures cost, block by block: counted, or timed.

use std::hint::black_box;

use rayon::prelude::*;

use super::costs::StepCosts;
use super::deck::{Deck, Group};
use super::options::Clock;
use crate::accel::Accel;
use crate::geom::Ray;
use crate::probe::Counts;
use crate::rays::Query;

/// Nanoseconds of each block, by `[group][block]`: by stored costs, or by the clock.
#[derive(Debug, Clone)]
pub(super) struct Score {
    pub(super) nanos: Vec<Vec<f64>>,
}

/// A score by counts, with the counts.
#[derive(Debug, Clone)]
pub(super) struct Counted {
    pub(super) score: Score,
    pub(super) steps_per_ray: f64,
    pub(super) tests_per_ray: f64,
}

impl Score {
    /// What each block costs, its groups weighed.
    pub(super) fn blocks(&self, deck: &Deck) -> Vec<f64> {
        let block = |b: usize| self.nanos.iter().zip(&deck.groups).map(|(nanos, group)| group.factor * nanos[b]).sum();
        (0..deck.blocks).map(block).collect()
    }

    /// What a ray costs.
    pub(super) fn nanos_per_ray(&self, deck: &Deck) -> f64 {
        self.blocks(deck).iter().sum::<f64>() / deck.weight().max(f64::MIN_POSITIVE)
    }
}

/// Casts all rays once and counts, on rayon's current threads; the result doesn't depend on how many.
pub(super) fn count(accel: &Accel, deck: &Deck) -> Counted {
    let costs = StepCosts::of(&accel.stats().spec);
    let counts: Vec<Vec<Counts>> = deck.groups.iter().map(|group| count_runs(accel, group)).collect();
    let nanos = |of: &Vec<Counts>| by_block(of.iter().map(|c| costs.nanos(c.steps(), c.tests)), deck.blocks);
    let per_ray = |what: fn(&Counts) -> u64| {
        let totals = counts.iter().map(|of| of.iter().map(what).sum::<u64>());
        let weighed: f64 = totals.zip(&deck.groups).map(|(total, group)| group.factor * total as f64).sum();
        weighed / deck.weight().max(f64::MIN_POSITIVE)
    };
    Counted {
        steps_per_ray: per_ray(Counts::steps),
        tests_per_ray: per_ray(|c| c.tests),
        score: Score { nanos: counts.iter().map(nanos).collect() },
    }
}

fn count_runs(accel: &Accel, group: &Group) -> Vec<Counts> {
    let run = |rays: &Vec<Ray>| {
        let (mut counts, mut hits) = (Counts::default(), Vec::new());
        for ray in rays {
            match group.query {
                Query::Closest => _ = accel.closest_counted(ray, &mut counts),
                Query::Occluded => _ = accel.occluded_counted(ray, &mut counts),
                Query::All => accel.all_hits_counted(ray, &mut hits, &mut counts),
            }
        }
        counts
    };
    group.runs.par_iter().map(run).collect()
}

/// Sums of the runs of each block.
fn by_block(runs: impl Iterator<Item = f64>, blocks: usize) -> Vec<f64> {
    let mut sums = vec![0.0; blocks];
    runs.enumerate().for_each(|(i, nanos)| sums[i % blocks] += nanos);
    sums
}

/// The best of `rounds` times of each run. Every structure casts a run in turn before any casts the next one, and each begins as often as
/// the others: whatever disturbs the machine for longer than a run meets all alike, and only so are errors of different blocks
/// independent. (Whole passes in turn called equal trees different in four of ten races on a busy machine.)
pub(super) fn time(accels: &[&Accel], deck: &Deck, rounds: usize, clock: Clock<'_>) -> Vec<Score> {
    let unknown = || deck.groups.iter().map(|g| vec![f64::INFINITY; g.runs.len()]).collect();
    let mut best: Vec<Vec<Vec<f64>>> = accels.iter().map(|_| unknown()).collect();
    for round in 0..rounds {
        for (g, group) in deck.groups.iter().enumerate() {
            for (r, rays) in group.runs.iter().enumerate() {
                for turn in 0..accels.len() {
                    let which = (turn + round + r) % accels.len();
                    let nanos = &mut best[which][g][r];
                    *nanos = nanos.min(time_run(accels[which], group.query, rays, clock));
                }
            }
        }
    }
    let score = |best: Vec<Vec<f64>>| Score {
        nanos: best.into_iter().map(|runs| by_block(runs.into_iter(), deck.blocks)).collect(),
    };
    best.into_iter().map(score).collect()
}

fn time_run(accel: &Accel, query: Query, rays: &[Ray], clock: Clock<'_>) -> f64 {
    let mut hits = Vec::new();
    let start = clock();
    // The sums keep the compiler from dropping what nobody reads.
    match query {
        Query::Closest => _ = black_box(rays.iter().filter_map(|r| accel.closest(r)).map(|h| h.t).sum::<f32>()),
        Query::Occluded => _ = black_box(rays.iter().filter(|r| accel.occluded(r)).count()),
        Query::All => rays.iter().for_each(|r| accel.all_hits(r, black_box(&mut hits))),
    }
    clock().saturating_sub(start) as f64
}
