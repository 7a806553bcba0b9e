//! The same tree twice: what the study says where there is no difference.

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::study::lab::{Entrant, Setting};
use crate::study::scope::Sample;

pub(super) struct Again;

/// With its rays' weight at zero the paper's heuristic grows the base's tree, byte for byte.
const SPECS: &str = "kd+sah,kd+rdh(paper,weight=0)";

impl Experiment for Again {
    fn name(&self) -> &'static str {
        "aa"
    }

    fn question(&self) -> &'static str {
        "Is there no difference where there can be none: between two copies of the same tree?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::MEDIUM, &[Mode::Primary, Mode::Whitted])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let lesson = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
        let wanted: Vec<_> = specs(SPECS)?.into_iter().map(|spec| (spec, &lesson)).collect();
        let built: Vec<_> = lab.build(&wanted, found).into_iter().flatten().collect();
        if let Some(other) = built.iter().find(|b| b.accel.fingerprint() != built[0].accel.fingerprint()) {
            return Err(format!("{} and {} should be the same tree, and are not", built[0].spec, other.spec));
        }
        let settings = vec![Setting::named("two copies of one tree")];
        let entrants: Vec<_> = built.iter().map(|built| Entrant { built, settings: settings.clone() }).collect();
        lab.measure(&entrants, &lab.rays(&view, mode), found);
        Ok(())
    }
}
