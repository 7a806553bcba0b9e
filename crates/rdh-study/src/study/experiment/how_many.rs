//! How many training rays it takes.

use rdh::{Query, RayClass, Spec, Training};

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::{Mode, RayBatch};
use crate::measure::tally;
use crate::plan::Protocol;
use crate::run::{Built, Lesson};
use crate::study::lab::{Setting, entrants};
use crate::study::scope::Sample;

pub(super) struct HowMany;

const SIZES: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];
const BASE: &str = "kd+sah";
const SPECS: &str = "kd+rdh(paper),kd+rdh";
/// What it takes where no ray is new.
const LEARNT: &str = "steps + tests / base, on the rays learnt from";
/// The setting that learns from the rays it is tested on.
const BOUND: &str = "the test rays themselves";

impl Experiment for HowMany {
    fn name(&self) -> &'static str {
        "how-many"
    }

    fn question(&self) -> &'static str {
        "How many rays does it take to learn from, and how far from the rays learnt are the unseen ones?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::FEW, &[Mode::Primary, Mode::Path])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let lesson = |&count: &usize| {
            let setting = Setting::at(format!("{count} training rays"), count as f64);
            (setting, lab.lesson(&view, mode, Protocol::Unseen, count))
        };
        // A first look that learns from fewer rays tries fewer.
        let most = 64 * lab.plan.training;
        let mut lessons: Vec<(Setting, Lesson)> = SIZES.iter().filter(|&&n| n <= most).map(lesson).collect();
        lessons.push((Setting::named(BOUND), lab.lesson(&view, mode, Protocol::Same, 0)));
        let (base, specs) = (specs(BASE)?, specs(SPECS)?);
        let none = Lesson::none();
        let mut wanted: Vec<(Spec, &Lesson)> = base.iter().map(|&spec| (spec, &none)).collect();
        let mut settings = vec![lessons.iter().map(|(s, _)| s.clone()).collect::<Vec<_>>()];
        for (setting, lesson) in &lessons {
            for &spec in &specs {
                wanted.push((spec, lesson));
                settings.push(vec![setting.clone()]);
            }
        }
        let built = lab.build(&wanted, found);
        lab.measure(&entrants(&built, &settings), &lab.rays(&view, mode), found);
        let [Some(base), others @ ..] = &built[..] else { return Ok(()) };
        for (i, &spec) in specs.iter().enumerate() {
            let of_spec = others.chunks(specs.len()).map(|of_lesson| of_lesson[i].as_ref());
            let point = |(built, (setting, lesson)): (Option<&Built>, &(Setting, Lesson))| {
                Some([setting.x?, learnt_ratio(built?, base, &lesson.training), 1.0])
            };
            let points = of_spec.zip(&lessons).filter_map(point).collect();
            found.curves.push(found.curve(LEARNT, spec, "training rays", points));
        }
        Ok(())
    }
}

/// Steps and tests against the base's, on the very rays that the structure was built for.
fn learnt_ratio(built: &Built, base: &Built, training: &Training) -> f64 {
    let cost = |built: &Built| -> u64 {
        let counts = batches(training).into_iter().map(|batch| tally(&built.accel, &batch).counts);
        counts.map(|c| c.steps() + c.tests).sum()
    };
    crate::stats::ratio(cost(built) as f64, cost(base) as f64)
}

fn batches(training: &Training) -> Vec<RayBatch> {
    let of = |query: Query| {
        let rays = training.samples().iter().filter(|s| s.query == query).map(|s| s.ray).collect();
        RayBatch { class: RayClass::Other, query, rays }
    };
    [Query::Closest, Query::Occluded].map(of).into()
}
