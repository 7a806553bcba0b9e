//! A structure against one built by areas, on rays by which neither was built.

use rdh::{Accel, Profile, Query, RayClass};
use serde::Serialize;

use crate::integrate::RayBatch;
use crate::measure::{difference, tally, time_interleaved};
use crate::stats::{median, paired_interval, ratio};

/// What decides a race.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Judge {
    /// Steps and tests: repeatable; between structures of one kind they mean time.
    Counts,
    /// CPU time of one thread, in so many interleaved rounds.
    Time {
        /// How often each structure casts all rays.
        rounds: usize,
    },
}

/// How a race ended; ratios are those of the structure to the base: below 1 is better.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Race {
    /// The structure's spec.
    pub spec: String,
    /// The base's.
    pub base: String,
    /// How many rays were cast.
    pub rays: usize,
    /// Of interior nodes and leaves visited.
    pub steps_ratio: f64,
    /// Of triangles in the leaves visited.
    pub tests_ratio: f64,
    /// Median over rounds; nothing where counts decide.
    pub time_ratio: Option<f64>,
    /// Student's t over the rounds.
    pub time_ratio_ci95: Option<[f64; 2]>,
    /// Rays with different answers.
    pub different: u64,
    /// Whether the structure is shown to be slower than the base, by more than the margin.
    pub slower: bool,
}

/// Races a structure against a base with the rays of a profile, each cast once in its class. It is slower if the whole 95 % interval of
/// its times lies above `1 + margin`; by counts, if its steps and tests together do.
pub fn race(accel: &Accel, base: &Accel, rays: &Profile, judge: Judge, margin: f64) -> Race {
    let batches = batches(rays);
    let [mine, theirs] = [accel, base].map(|accel| batches.iter().map(|b| tally(accel, b)).collect::<Vec<_>>());
    let total = |tallies: &[crate::measure::Tally], of: fn(&rdh::Counts) -> u64| {
        tallies.iter().map(|t| of(&t.counts)).sum::<u64>() as f64
    };
    let counts_ratio = |of| ratio(total(&mine, of), total(&theirs, of));
    let differences = mine.iter().zip(&theirs).filter_map(|(a, b)| difference(a, b));
    let times = match judge {
        Judge::Counts => None,
        Judge::Time { rounds } => Some(round_ratios(accel, base, &batches, rounds)),
    };
    let interval = times.as_ref().and_then(|ratios| paired_interval(ratios));
    let slower = match judge {
        Judge::Counts => counts_ratio(|c| c.steps() + c.tests) > 1.0 + margin,
        Judge::Time { .. } => interval.is_some_and(|[low, _]| low > 1.0 + margin),
    };
    Race {
        spec: accel.stats().spec.to_string(),
        base: base.stats().spec.to_string(),
        rays: rays.len(),
        steps_ratio: counts_ratio(rdh::Counts::steps),
        tests_ratio: counts_ratio(|c| c.tests),
        time_ratio: times.map(|ratios| median(&ratios)),
        time_ratio_ci95: interval,
        different: differences.map(|d| d.rays).sum(),
        slower,
    }
}

/// The rays by class and query.
fn batches(profile: &Profile) -> Vec<RayBatch> {
    let all = RayClass::ALL.into_iter().flat_map(|class| Query::ALL.map(|query| (class, query)));
    let batch = |(class, query)| {
        let samples = profile.samples().iter().filter(|s| s.class == class && s.query == query);
        RayBatch { class, query, rays: samples.map(|s| s.ray).collect() }
    };
    all.map(batch).filter(|batch| !batch.rays.is_empty()).collect()
}

/// The ratio of each round's times over all rays.
fn round_ratios(accel: &Accel, base: &Accel, batches: &[RayBatch], rounds: usize) -> Vec<f64> {
    let secs = time_interleaved(&[accel, base], batches, rounds);
    let total = |which: usize, round: usize| secs[which].iter().map(|batch| batch[round]).sum::<f64>();
    // A round of few rays may be shorter than the clock's tick: as if it were one nanosecond longer.
    (0..rounds).map(|round| ratio(1e9 * total(0, round), 1e9 * total(1, round))).collect()
}
