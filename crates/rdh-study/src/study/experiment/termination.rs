//! When to stop: the same rule for both heuristics, and what is saved where no rays are traced.

use rdh::{Aabb, Spec};
use rdh_scene::Kind;

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::{Mode, RayBatch, derived_seed};
use crate::plan::Protocol;
use crate::run::Built;
use crate::study::lab::{Entrant, Setting, entrants};
use crate::study::lines::uniform_lines;
use crate::study::scope::Sample;

pub(super) struct Termination;

/// One rule a setting, for both heuristics: base and spec.
const RULES: [(&str, &str); 5] = [
    ("stop=auto", "kd+sah,kd+rdh"),
    ("stop=cost", "kd(stop=cost)+sah,kd(stop=cost)+rdh"),
    ("stop=paper", "kd(stop=paper)+sah,kd(stop=paper)+rdh"),
    ("prune=none", "kd(prune=none)+sah,kd(prune=none)+rdh"),
    ("prune=area", "kd(prune=area)+sah,kd(prune=area)+rdh"),
];
/// What leaves nodes as they are where rays spend little, against the base; with areas as a control.
const IDLE: &str = "kd+sah,kd+rdh,kd(idle=0.00001)+rdh,kd(idle=0.0001)+rdh,kd(idle=0.001)+rdh,kd(idle=0.0001)+sah";
/// Scenes of up to so many triangles try the rules, too.
const RULES_UP_TO: usize = 150_000;

impl Experiment for Termination {
    fn name(&self) -> &'static str {
        "termination"
    }

    fn question(&self) -> &'static str {
        "What does each stop rule do to both heuristics; what do dense scenes save where no rays are traced, and what do rays pay that come there after all?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        let modes = [Mode::Primary, Mode::Path];
        let dense = |job: &Job| scope.entries.iter().any(|e| e.id == job.scene && e.kind == Kind::Dense);
        let one_view = Sample { views: 1, large_views: 1, quick_triangles: 30_000, ..Sample::ALL };
        let mut jobs = scope.jobs(self.name(), one_view, &modes);
        let few = scope.jobs(self.name(), Sample::FEW, &modes);
        jobs.retain(|job| dense(job) || few.contains(job));
        jobs
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        if lab.mesh().len() <= RULES_UP_TO {
            rules(lab, found)?;
        }
        idle(lab, found)
    }
}

fn rules(lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
    let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
    let lesson = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
    let mut wanted: Vec<(&str, Spec)> = Vec::new();
    for (setting, text) in RULES {
        wanted.extend(specs(text)?.into_iter().map(|spec| (setting, spec)));
    }
    let to_build: Vec<_> = wanted.iter().map(|&(_, spec)| (spec, &lesson)).collect();
    let built = lab.build(&to_build, found);
    let settings: Vec<Vec<Setting>> = wanted.iter().map(|(setting, _)| vec![Setting::named(*setting)]).collect();
    lab.measure(&entrants(&built, &settings), &lab.rays(&view, mode), found);
    Ok(())
}

/// One view is learnt; its own rays, another view's and uniform lines pay.
fn idle(lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
    let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
    let lesson = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
    let wanted: Vec<_> = specs(IDLE)?.into_iter().map(|spec| (spec, &lesson)).collect();
    let built: Vec<Built> = lab.build(&wanted, found).into_iter().flatten().collect();
    measure(lab, &built, "idle: the learnt view's rays", &lab.rays(&view, mode), found);
    if let Some(other) = lab.another_view(&view.name) {
        measure(lab, &built, "idle: another view's rays", &lab.rays(&other, mode), found);
    }
    measure(lab, &built, "idle: uniform lines", &[lines(lab, &lab.stage.bounds())], found);
    Ok(())
}

fn lines(lab: &Lab<'_>, bounds: &Aabb) -> RayBatch {
    let [columns, rows] = lab.plan.size;
    uniform_lines(bounds, columns * rows, derived_seed(lab.plan.seed, u64::from(b'U')))
}

fn measure(lab: &Lab<'_>, built: &[Built], setting: &str, batches: &[RayBatch], found: &mut Record) {
    let entrants: Vec<_> =
        built.iter().map(|built| Entrant { built, settings: vec![Setting::named(setting)] }).collect();
    lab.measure(&entrants, batches, found);
}
