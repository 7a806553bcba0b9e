//! The third set's say: what was chosen against the best structure by areas, on rays that neither builders nor the choice have seen.

use serde::{Deserialize, Serialize};

use super::deck::Deck;
use super::evidence::{Comparison, Measure};
use super::options::{Clock, TuneOptions};
use super::verdict::{Rule, compare};
use super::{Tuned, score};
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
    options.check(clock.is_some())?;
    let deck = Deck::deal(unseen.samples(), &options.class_weights);
    let Some(sah) = tuned.sah.as_ref().filter(|_| deck.too_few("unseen").is_none()) else { return Ok(None) };
    let base = sah.stats().spec;
    let rule = |measure| Rule { measure, margin: 0.0, interval_risk: options.risk / 2.0 };
    let counted = [&tuned.accel, sah].map(|accel| score::count(accel, &deck).score);
    let timed = clock.map(|clock| score::time(&[&tuned.accel, sah], &deck, options.rounds, clock));
    Ok(Some(Confirmed {
        rays: deck.samples(),
        counts: compare((&counted[0], &counted[1]), &deck, rule(Measure::Counts), base),
        time: timed.map(|t| compare((&t[0], &t[1]), &deck, rule(Measure::Time), base)),
    }))
}
