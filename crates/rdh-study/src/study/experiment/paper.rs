//! The paper's own measurement: its protocol, its stop rule, ray casting and ray tracing.

use rdh::Spec;

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::study::lab::{Setting, entrants};
use crate::study::scope::Sample;

pub(super) struct Paper;

/// Base and specs of each setting: the paper's rule for both sides, and what stands in its place today.
const SETTINGS: [(&str, &str); 2] = [
    ("the paper's rule", "kd(stop=paper,prune=none)+sah,kd(stop=paper,prune=none)+rdh(paper)"),
    ("tuned", "kd+sah,kd+rdh(paper),kd+rdh"),
];

impl Experiment for Paper {
    fn name(&self) -> &'static str {
        "paper"
    }

    fn question(&self) -> &'static str {
        "Are the paper's two rows reproduced, with its protocol: a subset of the frame's own rays to learn from, the whole frame counted?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::ALL, &[Mode::Primary, Mode::Whitted])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let lesson = lab.lesson(&view, mode, Protocol::Paper, lab.plan.training);
        let mut wanted: Vec<(&str, Spec)> = Vec::new();
        for (setting, text) in SETTINGS {
            wanted.extend(specs(text)?.into_iter().map(|spec| (setting, spec)));
        }
        let to_build: Vec<_> = wanted.iter().map(|&(_, spec)| (spec, &lesson)).collect();
        let built = lab.build(&to_build, found);
        let settings: Vec<Vec<Setting>> = wanted.iter().map(|(setting, _)| vec![Setting::named(*setting)]).collect();
        lab.measure(&entrants(&built, &settings), &lab.rays(&view, mode), found);
        for row in &mut found.rows {
            row.protocol = Protocol::Paper;
        }
        Ok(())
    }
}
