//! What the same effort gives without rays: better searches by area, and rays that nobody casts.

use rdh::Spec;

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::run::Lesson;
use crate::study::lab::{Setting, entrants};
use crate::study::scope::Sample;

pub(super) struct Controls;

const AREAS: &str = "kd+sah,kd(prune=none)+sah,kd(stop=cost)+sah,kd(split=exact)+sah";
const RAYS: &str = "kd+rdh(paper),kd+rdh";
const BY_AREA: &str = "areas, other effort";
const BY_RAYS: &str = "the view's rays";
const BY_LINES: &str = "as many uniform lines instead of the view's rays";

impl Experiment for Controls {
    fn name(&self) -> &'static str {
        "controls"
    }

    fn question(&self) -> &'static str {
        "How much of the gain does the same effort give without knowing the rays?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::FEW, &[Mode::Primary, Mode::Whitted, Mode::Path])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let lesson = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
        let lines = lab.uniform_lesson(lesson.training.len());
        let none = Lesson::none();
        let mut wanted: Vec<(Spec, &Lesson)> = specs(AREAS)?.into_iter().map(|spec| (spec, &none)).collect();
        let mut settings = vec![vec![Setting::named(BY_AREA)]; wanted.len()];
        for (setting, lesson) in [(BY_RAYS, &lesson), (BY_LINES, &lines)] {
            for spec in specs(RAYS)? {
                wanted.push((spec, lesson));
                settings.push(vec![Setting::named(setting)]);
            }
            // The base stands beside both.
            settings[0].push(Setting::named(setting));
        }
        let built = lab.build(&wanted, found);
        lab.measure(&entrants(&built, &settings), &lab.rays(&view, mode), found);
        Ok(())
    }
}
