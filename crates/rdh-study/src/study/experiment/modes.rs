//! The main table: every mode and class of rays, against the tuned baseline, on rays that nothing was trained on.

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::study::lab::{Setting, entrants};
use crate::study::scope::Sample;

pub(super) struct Modes;

/// The first is the base.
const SPECS: &str = "kd+sah,kd+rdh(paper),kd+rdh";

impl Experiment for Modes {
    fn name(&self) -> &'static str {
        "modes"
    }

    fn question(&self) -> &'static str {
        "What does knowing the rays gain, for every kind of ray, on rays that the tree was not built for?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::TWO, &Mode::ALL)
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let lesson = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
        let wanted: Vec<_> = specs(SPECS)?.into_iter().map(|spec| (spec, &lesson)).collect();
        let built = lab.build(&wanted, found);
        let settings = vec![vec![Setting::named("unseen rays of the same view")]; built.len()];
        lab.measure(&entrants(&built, &settings), &lab.rays(&view, mode), found);
        Ok(())
    }
}
