//! Choosing a structure.

use pyo3::prelude::*;
use rayon::ThreadPool;
use rdh::tune::TuneOptions;
use rdh::{Accel, BuildOptions, HeldOut, Mesh, Profile, Spec, Training};
use rdh_study::clock::thread_nanos;

use crate::arrays::refuse;
use crate::batch::supervise;
use crate::errors::from_library;

/// By what structures are compared in the end.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Measure {
    Time,
    Counts,
}

impl Measure {
    /// # Errors
    /// `ValueError` for any other name.
    pub(crate) fn read(name: &str) -> PyResult<Self> {
        match name {
            "time" => Ok(Self::Time),
            "counts" => Ok(Self::Counts),
            _ => Err(refuse("by", format_args!("'{name}' is neither time nor counts"))),
        }
    }
}

/// Chooses from a profile's first two sets, and keeps the third one with the structure.
///
/// # Errors
/// What the library says, or what a signal's handler raises.
pub(crate) fn choose(
    py: Python<'_>,
    pool: &ThreadPool,
    mesh: &Mesh,
    candidates: &[Spec],
    profile: &Profile,
    measure: Measure,
    seed: u64,
) -> PyResult<Accel> {
    let [training, held_out, unseen] = profile.clone().split_profiles(seed);
    let training = Training::from_samples(training.samples().to_vec());
    let held_out = HeldOut::from_samples(held_out.samples().to_vec());
    let tuned = supervise(py, pool, |cancel| {
        let cancelled = || cancel.is_wanted();
        let build = BuildOptions { cancel: Some(&cancelled), ..BuildOptions::default() };
        let options = TuneOptions { build, ..TuneOptions::default() };
        let clock: Option<rdh::tune::Clock<'_>> = (measure == Measure::Time).then_some(&thread_nanos);
        rdh::tune(mesh, candidates, &training, &held_out, &options, clock)
    })?;
    let accel = tuned.map_err(from_library)?.accel;
    let provenance = rdh::Provenance { seed: Some(seed), unseen: Some(unseen), ..accel.provenance().clone() };
    Ok(accel.with_provenance(provenance))
}
