//! The rays of one column through a group of lanes: answers first, then interleaved rounds.

use super::columns::Column;
use super::lanes::{Batch, Lane};
use super::process::{Cast, Process, Trouble};
use super::registry::{Form, Pace};
use super::rows::{BenchRow, Profile, SameRays};
use super::verify::Difference;
use crate::stats;

/// A group of lanes, and what goes wrong with them.
pub(crate) struct Heat<'h, 'o> {
    pub(crate) lanes: &'h [Lane<'o>],
    pub(crate) processes: &'h mut [Process],
    pub(crate) rounds: usize,
    /// Lanes by their labels, and why they have no times.
    pub(crate) trouble: Vec<(String, String)>,
}

/// What is known of a lane in a column.
#[derive(Debug)]
pub(crate) struct Outcome {
    label: String,
    /// The competitor; nothing for ours.
    pub(crate) base: Option<String>,
    version: Option<String>,
    form: Form,
    profile: Profile,
    build_secs: f64,
    bytes: u64,
    rays: usize,
    /// Hits of our first structure.
    reference_hits: u64,
    difference: Difference,
    /// One of the casts; all are alike but for their times.
    last: Cast,
    nanos: Vec<f64>,
    same_rays: Vec<SameRays>,
}

/// A lane whose answers are known.
struct Runner {
    /// Of the heat's lanes.
    lane: usize,
    hits: u64,
    difference: Difference,
    casts: Vec<Cast>,
}

impl Heat<'_, '_> {
    /// All rays: ours and the engines that get as many.
    pub(crate) fn full(&mut self, batch: &Batch, outcomes: &mut Vec<Outcome>) {
        for runner in self.run(batch, |lane| lane.pace == Pace::Full) {
            let outcome = self.outcome(&runner, batch);
            // Ours race in each group.
            match outcomes.iter_mut().find(|known| known.label == outcome.label) {
                Some(known) => known.nanos.extend(outcome.nanos),
                None => outcomes.push(outcome),
            }
        }
    }

    /// Fewer rays: slow engines, and ours once more on the same.
    pub(crate) fn slow(&mut self, batch: &Batch, outcomes: &mut Vec<Outcome>) {
        if self.lanes.iter().all(|lane| lane.pace == Pace::Full) {
            return;
        }
        let runners = self.run(batch, |lane| lane.pace == Pace::Slow || lane.base.is_none());
        let (ours, slow): (Vec<_>, Vec<_>) = runners.into_iter().partition(|r| self.lanes[r.lane].base.is_none());
        let same_rays: Vec<_> = ours.iter().map(|runner| self.outcome(runner, batch).as_same_rays()).collect();
        for runner in slow {
            outcomes.push(Outcome { same_rays: same_rays.clone(), ..self.outcome(&runner, batch) });
        }
    }

    /// In each round all cast in turn, and each round begins with another one. Casting for the answers gets them warm.
    fn run(&mut self, batch: &Batch, wanted: impl Fn(&Lane<'_>) -> bool) -> Vec<Runner> {
        let wanted = |lane: &Lane<'_>| wanted(lane) && lane.takes(batch.column);
        let lanes: Vec<usize> = (0..self.lanes.len()).filter(|&lane| wanted(&self.lanes[lane])).collect();
        let mut runners: Vec<Runner> = lanes.into_iter().filter_map(|lane| self.verified(lane, batch)).collect();
        let mut lost = vec![false; runners.len()];
        for round in 0..self.rounds {
            for turn in 0..runners.len() {
                let which = (round + turn) % runners.len();
                lost[which] = lost[which] || !self.cast(&mut runners[which], batch);
            }
        }
        let mut lost = lost.into_iter();
        runners.retain(|_| lost.next() == Some(false));
        runners
    }

    fn verified(&mut self, lane: usize, batch: &Batch) -> Option<Runner> {
        match self.lanes[lane].verify(self.processes, batch) {
            Ok((difference, hits)) => Some(Runner { lane, hits, difference, casts: Vec::new() }),
            Err(trouble) => {
                self.note(lane, trouble);
                None
            }
        }
    }

    /// Whether it has cast the rays, with as many hits as before.
    fn cast(&mut self, runner: &mut Runner, batch: &Batch) -> bool {
        let cast = self.lanes[runner.lane].cast(self.processes, batch);
        match cast {
            Ok(cast) if cast.hits == runner.hits => {
                runner.casts.push(cast);
                true
            }
            Ok(cast) => {
                let reason = format!("{} hits when it is timed, {} before", cast.hits, runner.hits);
                self.note(runner.lane, Trouble::Failed(reason));
                false
            }
            Err(trouble) => {
                self.note(runner.lane, trouble);
                false
            }
        }
    }

    fn note(&mut self, lane: usize, trouble: Trouble) {
        let (Trouble::Absent(reason) | Trouble::Failed(reason)) = trouble;
        self.trouble.push((self.lanes[lane].label.clone(), reason));
    }

    fn outcome(&self, runner: &Runner, batch: &Batch) -> Outcome {
        let lane = &self.lanes[runner.lane];
        Outcome {
            label: lane.label.clone(),
            base: lane.base.clone(),
            version: lane.version.clone(),
            form: lane.form,
            profile: lane.profile,
            build_secs: lane.build_secs,
            bytes: lane.bytes,
            rays: batch.rays.len(),
            reference_hits: batch.reference.hits(),
            difference: runner.difference,
            last: runner.casts.last().copied().unwrap_or_default(),
            nanos: runner.casts.iter().map(|cast| cast.nanos.max(1) as f64).collect(),
            same_rays: Vec::new(),
        }
    }
}

impl Outcome {
    /// As it is reported.
    pub(crate) fn row(self, scene: &str, view: &str, triangles: usize, column: Column, tolerance: f64) -> BenchRow {
        let agrees = match self.base {
            None => self.difference.total() == 0,
            Some(_) => self.difference.is_tolerable(self.reference_hits, tolerance),
        };
        BenchRow {
            scene: scene.to_owned(),
            view: view.to_owned(),
            triangles,
            column,
            form: self.form,
            profile: self.profile,
            rays: self.rays,
            hits: self.last.hits,
            t_sum: self.last.t_sum,
            mrays_per_sec: self.median_rate(),
            mrays_per_sec_best: self.rate(self.nanos.iter().copied().fold(f64::INFINITY, f64::min)),
            build_secs: self.build_secs,
            bytes: self.bytes,
            lost: self.difference.lost,
            extra: self.difference.extra,
            differ: self.difference.differ,
            agrees,
            engine: self.label,
            base: self.base,
            version: self.version,
            same_rays: self.same_rays,
        }
    }

    fn as_same_rays(&self) -> SameRays {
        SameRays { spec: self.label.clone(), mrays_per_sec: self.median_rate() }
    }

    fn median_rate(&self) -> f64 {
        self.rate(stats::median(&self.nanos))
    }

    fn rate(&self, nanos: f64) -> f64 {
        self.rays as f64 * 1e3 / nanos
    }
}
