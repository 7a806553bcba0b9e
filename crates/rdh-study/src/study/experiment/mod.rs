//! The study's questions, one file each.

mod again;
mod assumptions;
mod blend;
mod bound;
mod controls;
pub mod frames;
mod how_many;
mod modes;
mod occlusion;
mod paper;
pub mod spd;
mod termination;
mod which_rays;

use rdh::Spec;

use super::lab::Lab;
use super::record::{Job, Record};
use super::scope::Scope;

/// A question, and how it is answered.
pub trait Experiment: Sync {
    /// Its name, as in `--experiment`.
    fn name(&self) -> &'static str;

    /// What it asks, in a sentence.
    fn question(&self) -> &'static str;

    /// What it takes to answer it over a scope.
    fn jobs(&self, scope: &Scope) -> Vec<Job>;

    /// Does one job; `found` names it and takes what is found. What goes wrong with single structures goes there too.
    ///
    /// # Errors
    /// Why the job can't be done at all.
    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String>;
}

/// All experiments, in the order of the report.
pub const EXPERIMENTS: &[&dyn Experiment] = &[
    &paper::Paper,
    &modes::Modes,
    &assumptions::Assumptions,
    &which_rays::WhichRays,
    &how_many::HowMany,
    &blend::Blend,
    &occlusion::Occlusion,
    &controls::Controls,
    &termination::Termination,
    &frames::Frames,
    &bound::Bound,
    &again::Again,
    &spd::Spd,
];

/// The names of all experiments, with commas between them.
pub fn names() -> String {
    EXPERIMENTS.iter().map(|e| e.name()).collect::<Vec<_>>().join(", ")
}

/// An experiment by its name.
pub fn find(name: &str) -> Option<&'static dyn Experiment> {
    EXPERIMENTS.iter().find(|e| e.name() == name).copied()
}

/// Specs that are written in the code.
///
/// # Errors
/// None, for good text; the text is checked by a test of each experiment all the same.
fn specs(text: &str) -> Result<Vec<Spec>, String> {
    Spec::list(text).map_err(|e| e.to_string())
}
