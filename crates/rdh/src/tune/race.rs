//! Successive halving: many candidates get a cheap look, few a dear one.

use super::deck::Deck;
use super::evidence::{Evidence, Measure, Outcome, RaysUsed, Rung, Trial};
use super::options::Clock;
use super::score::{self, Score};
use super::train::Workshop;
use super::{Tuned, verdict, words};
use crate::accel::Accel;
use crate::error::{Error, Result};

/// A candidate that was built and is still in the race.
#[derive(Debug)]
pub(super) struct Runner {
    /// Which candidate.
    pub(super) index: usize,
    pub(super) accel: Accel,
    /// By counts.
    pub(super) counted: Score,
    /// By the last rung: of the timed one a score for each session.
    pub(super) scores: Vec<Score>,
    nanos_per_ray: f64,
}

/// Rounds of the timed rung before the last one.
const SPRINT_ROUNDS: usize = 5;
/// So many of each kind reach the last rung, if there are as many.
const LEAST: usize = 2;

/// The whole race.
pub(super) fn run(shop: &Workshop<'_>, deck: &Deck, lesson: &Deck) -> Result<Tuned> {
    let mut trials: Vec<Trial> = shop.candidates.iter().map(|&spec| Trial::of(spec)).collect();
    let mut field = by_counts(shop, deck, lesson, &mut trials)?;
    if let Some(clock) = shop.clock {
        if field.iter().any(|runners| runners.len() > LEAST) {
            by_time(&mut field, deck, SPRINT_ROUNDS, clock, &mut trials);
            for runners in &mut field {
                keep(runners, half(runners.len()), &mut trials);
            }
        }
        by_time(&mut field, deck, shop.options.rounds, clock, &mut trials);
        let first: Vec<Vec<Score>> = field.iter().flatten().map(|r| r.scores.clone()).collect();
        by_time(&mut field, deck, shop.options.rounds, clock, &mut trials);
        for (runner, first) in field.iter_mut().flatten().zip(first) {
            runner.scores.extend(first);
        }
    }
    Ok(verdict::decide(shop, field, deck, used(deck, lesson), trials))
}

/// Those that need no rays, and those that do.
pub(super) type Field = [Vec<Runner>; 2];

/// What is kept where there is nothing to choose by: the first structure by areas that can be built.
pub(super) fn only_areas(shop: &Workshop<'_>, (deck, lesson): (&Deck, &Deck), doubt: &str) -> Result<Tuned> {
    let mut trials: Vec<Trial> = shop.candidates.iter().map(|&spec| Trial::of(spec)).collect();
    let mut taken = None;
    for (index, spec) in shop.candidates.iter().enumerate() {
        if spec.needs_rays() || taken.is_some() {
            trials[index].error = Some("not tried".to_owned());
        } else {
            taken = build(shop, index, &mut trials)?;
        }
    }
    let accel = taken.ok_or_else(|| nothing_by_areas(&trials))?;
    let spec = accel.stats().spec;
    let evidence = Evidence {
        version: Evidence::VERSION,
        spec,
        base: spec,
        outcome: Outcome::TooFewRays,
        reason: words::too_few(doubt, &spec),
        measure: Measure::Counts,
        risk: shop.options.risk,
        margin: 0.0,
        tried: 0,
        rays: used(deck, lesson),
        trials,
    };
    Ok(Tuned { accel, sah: None, evidence })
}

/// Builds all candidates, one after the other, counts, and keeps the better half of each kind; of the others nothing stays in
/// memory.
fn by_counts(shop: &Workshop<'_>, deck: &Deck, lesson: &Deck, trials: &mut [Trial]) -> Result<Field> {
    let knowing = shop.candidates.iter().filter(|s| s.needs_rays()).count();
    let room = [half(shop.candidates.len() - knowing), half(knowing)];
    let mut kept = [Vec::new(), Vec::new()];
    for (index, spec) in shop.candidates.iter().enumerate() {
        let Some(accel) = build(shop, index, trials)? else { continue };
        trials[index].training_nanos_per_ray = Some(score::count(&accel, lesson).score.nanos_per_ray(lesson));
        let counted = score::count(&accel, deck);
        trials[index].steps_per_ray = Some(counted.steps_per_ray);
        trials[index].tests_per_ray = Some(counted.tests_per_ray);
        let mut runner =
            Runner { index, accel, counted: counted.score.clone(), scores: Vec::new(), nanos_per_ray: 0.0 };
        runner.step(counted.score, deck, Measure::Counts, trials);
        let kind = usize::from(spec.needs_rays());
        kept[kind].push(runner);
        keep(&mut kept[kind], room[kind], trials);
    }
    if kept[0].is_empty() { Err(nothing_by_areas(trials)) } else { Ok(kept) }
}

/// Times all that are in the race, in turn.
fn by_time(field: &mut Field, deck: &Deck, rounds: usize, clock: Clock<'_>, trials: &mut [Trial]) {
    let accels: Vec<&Accel> = field.iter().flatten().map(|r| &r.accel).collect();
    let scores = score::time(&accels, deck, rounds, clock);
    for (runner, score) in field.iter_mut().flatten().zip(scores) {
        runner.step(score, deck, Measure::Time, trials);
    }
}

/// Builds a candidate, and notes what became of it.
fn build(shop: &Workshop<'_>, index: usize, trials: &mut [Trial]) -> Result<Option<Accel>> {
    let built = shop.build(&shop.candidates[index])?;
    let trial = &mut trials[index];
    trial.build_secs = built.secs;
    match built.accel {
        Ok(accel) => {
            trial.bytes = Some(accel.stats().bytes);
            Ok(Some(accel))
        }
        Err(error) => {
            trial.error = Some(error.to_string());
            Ok(None)
        }
    }
}

impl Runner {
    /// Takes a rung's score.
    fn step(&mut self, score: Score, deck: &Deck, measure: Measure, trials: &mut [Trial]) {
        self.nanos_per_ray = score.nanos_per_ray(deck);
        self.scores = vec![score];
        trials[self.index].rungs.push(Rung { measure, nanos_per_ray: self.nanos_per_ray, kept: true });
    }
}

fn half(count: usize) -> usize {
    count.div_ceil(2).max(LEAST)
}

/// Keeps the best; of equals those that were given first.
fn keep(runners: &mut Vec<Runner>, room: usize, trials: &mut [Trial]) {
    runners.sort_by(|a, b| a.nanos_per_ray.total_cmp(&b.nanos_per_ray).then(a.index.cmp(&b.index)));
    for out in runners.drain(room.min(runners.len())..) {
        if let Some(rung) = trials[out.index].rungs.last_mut() {
            rung.kept = false;
        }
    }
}

fn nothing_by_areas(trials: &[Trial]) -> Error {
    let first = trials.iter().find(|t| !t.spec.needs_rays());
    let why = first.map_or_else(String::new, |t| format!("{}: {}", t.spec, t.error.as_deref().unwrap_or("not tried")));
    Error::Tuning { reason: format!("no structure by areas could be built: {why}") }
}

fn used(deck: &Deck, lesson: &Deck) -> RaysUsed {
    RaysUsed {
        training: lesson.samples(),
        held_out: deck.samples(),
        dropped: deck.dropped + lesson.dropped,
        effective: deck.effective,
        blocks: deck.blocks,
    }
}
