//! The third set's say: what was chosen against the best structure by areas, on rays that neither builders nor the choice have seen.

use serde::{Deserialize, Serialize};

use super::Tuned;
use super::deck::Deck;
use super::evidence::{Comparison, Measure};
use super::options::{Clock, TuneOptions};
use super::score::{self, Score};
use super::verdict::{Rule, compare};
use crate::accel::Accel;
use crate::error::Result;
use crate::rays::Unseen;

/// A choice on unseen rays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Confirmed {
    /// Distinct unseen rays that could be used.
    pub rays: usize,
    /// By counts.
    pub counts: Comparison,
    /// By the clock, if there is one.
    pub time: Option<Comparison>,
}

impl Confirmed {
    /// Whether what was chosen is surely slower than the structure by areas, at a risk of `risk`: by time where there is a clock,
    /// else by counts.
    pub fn is_slower(&self, risk: f64) -> bool {
        self.time.as_ref().unwrap_or(&self.counts).p_slower < risk
    }
}

/// Compares what was chosen with the best structure by areas on unseen rays. Nothing if it is that one, or if there are too few
/// rays to say anything.
///
/// # Errors
/// Options that make no sense.
pub fn confirm(
    tuned: &Tuned,
    unseen: &Unseen,
    options: &TuneOptions<'_>,
    clock: Option<Clock<'_>>,
) -> Result<Option<Confirmed>> {
    match &tuned.sah {
        Some(sah) => confirm_against(&tuned.accel, sah, unseen, options, clock),
        None => options.check(clock.is_some()).map(|()| None),
    }
}

/// [`confirm`], of any structure against any other one: whoever chose it, and when. Nothing if there are too few rays.
///
/// # Errors
/// Options that make no sense.
pub fn confirm_against(
    accel: &Accel,
    sah: &Accel,
    unseen: &Unseen,
    options: &TuneOptions<'_>,
    clock: Option<Clock<'_>>,
) -> Result<Option<Confirmed>> {
    options.check(clock.is_some())?;
    let deck = Deck::deal(unseen.samples(), &options.class_weights);
    if deck.too_few("unseen").is_some() {
        return Ok(None);
    }
    let base = sah.stats().spec;
    let rule = |measure| Rule { measure, margin: 0.0, interval_risk: options.risk / 2.0 };
    let pair = [accel, sah];
    let counted = pair.map(|accel| vec![score::count(accel, &deck).score]);
    let timed = clock.map(|clock| sessions(pair, &deck, options.rounds, clock));
    Ok(Some(Confirmed {
        rays: deck.samples(),
        counts: compare((&counted[0], &counted[1]), &deck, rule(Measure::Counts), base),
        time: timed.map(|t| compare((&t[0], &t[1]), &deck, rule(Measure::Time), base)),
    }))
}

/// Times of both in two sessions.
fn sessions(pair: [&Accel; 2], deck: &Deck, rounds: usize, clock: Clock<'_>) -> [Vec<Score>; 2] {
    let mut scores = [Vec::new(), Vec::new()];
    for _ in 0..2 {
        let session = score::time(&pair, deck, rounds, clock);
        scores.iter_mut().zip(session).for_each(|(of, score)| of.push(score));
    }
    scores
}
