//! Choosing: candidates are built from the training rays, raced on the held-out rays, and the winner is never worse than
//! the best structure that needs no rays, or it isn't taken.
//!
//! ```text
//!  candidates --build from Training--> counted on HeldOut --half of them--> timed once --half--> timed in turn --> verdict
//!                                       steps and tests,                     only with a clock
//!                                       by stored costs
//! ```
//! Structures by area and structures for rays are halved apart, so that both are there at the end. The last two rungs are
//! left out without a clock; what remains is the same on every machine and at every time.

mod candidates;
mod confirm;
mod costs;
mod deck;
mod evidence;
mod interval;
mod options;
mod race;
mod score;
mod train;
mod verdict;
mod words;

pub use candidates::{CANDIDATES, Candidate};
pub use confirm::{Confirmed, confirm, confirm_against};
pub use evidence::{ClassRatio, Comparison, Evidence, Measure, Outcome, RaysUsed, Rung, Trial};
pub use options::{Clock, TuneOptions};

use crate::accel::{Accel, Provenance};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::rays::{HeldOut, Training};
use crate::spec::Spec;
use deck::Deck;
use train::Workshop;

/// What was chosen, and why.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The structure to cast rays through. Its [`Provenance`] holds the evidence as JSON, so that it is saved with it.
    pub accel: Accel,
    /// The best structure that needs no rays, against which it was chosen; nothing if it is that one itself.
    pub sah: Option<Accel>,
    /// What was tried, and why this was taken.
    pub evidence: Evidence,
}

/// Builds the candidates from `training`, races them on `held_out`, and returns the fastest one of which it is sure, at 95 % for
/// all that were tried together, that it is not slower than any of the candidates that need no rays; else the best of these.
///
/// With a `clock` (nanoseconds; best the calling thread's CPU time) the last decision is by time; without one by steps and tests
/// alone, and repeatable. A candidate that can't be built is recorded, and the others go on. With too few rays to be sure of
/// anything, the first candidate that needs none is built and returned.
///
/// Time: that of all builds, and of casting the held-out rays a few times. Memory: half of the candidates' trees at once.
///
/// # Errors
/// [`Error::Tuning`] for candidates or options that make no sense; the reason of the first candidate without rays if none of
/// them can be built; cancellation.
pub fn tune(
    mesh: &Mesh,
    candidates: &[Spec],
    training: &Training,
    held_out: &HeldOut,
    options: &TuneOptions<'_>,
    clock: Option<Clock<'_>>,
) -> Result<Tuned> {
    check(candidates)?;
    options.check(clock.is_some())?;
    let deck = Deck::deal(held_out.samples(), &options.class_weights);
    let lesson = Deck::deal(training.samples(), &options.class_weights);
    let shop = Workshop { mesh, candidates, training, options, clock };
    let tuned = match deck.too_few("held-out").or_else(|| lesson.too_few("training")) {
        Some(doubt) => race::only_areas(&shop, (&deck, &lesson), &doubt),
        None => race::run(&shop, &deck, &lesson),
    }?;
    Ok(tuned.noted())
}

/// What the spec `auto` means: [`tune`] over [`Spec::candidates`] by counts. A third of the rays, by a hash of their bits, is
/// held out; builders see the others.
///
/// # Errors
/// As [`tune`].
pub fn auto(mesh: &Mesh, rays: &Training, build: &BuildOptions<'_>) -> Result<Tuned> {
    let (training, held_out) = rays.part();
    tune(
        mesh,
        &Spec::candidates(),
        &training,
        &held_out,
        &TuneOptions { build: *build, ..TuneOptions::default() },
        None,
    )
}

impl Tuned {
    /// With the evidence among the structure's notes.
    fn noted(self) -> Self {
        let evidence = serde_json::to_value(&self.evidence).ok();
        let accel = self.accel.with_provenance(Provenance { evidence, ..Provenance::default() });
        Self { accel, ..self }
    }
}

fn check(candidates: &[Spec]) -> Result<()> {
    let fail = |reason: String| Err(Error::Tuning { reason });
    if let Some(twice) =
        candidates.iter().enumerate().find_map(|(i, spec)| candidates[..i].contains(spec).then_some(spec))
    {
        return fail(format!("candidate '{twice}' is given twice"));
    }
    if candidates.contains(&Spec::AUTO) {
        return fail("'auto' is the choice itself, not a candidate".to_owned());
    }
    if candidates.iter().all(Spec::needs_rays) {
        return fail("there must be a candidate that needs no rays, such as bvh8+sah, to be compared with".to_owned());
    }
    Ok(())
}
