//! How rays and areas are mixed: the poster gives no weight, so a band of them is tried.

use rdh::Spec;

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::run::Lesson;
use crate::study::lab::{Setting, entrants};
use crate::study::scope::Sample;

pub(super) struct Blend;

const WEIGHTS: [f64; 6] = [0.0, 0.25, 0.5, 0.75, 0.9, 1.0];
const PRIORS: [f64; 6] = [0.0, 1.0, 4.0, 16.0, 64.0, 256.0];

impl Experiment for Blend {
    fn name(&self) -> &'static str {
        "blend"
    }

    fn question(&self) -> &'static str {
        "How much should the rays weigh against the areas?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::FEW, &[Mode::Primary, Mode::Whitted])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let lesson = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
        let mut wanted: Vec<(Spec, Vec<Setting>)> = vec![(Spec::default(), Vec::new())];
        for (text, setting) in variants() {
            wanted.extend(specs(&text)?.into_iter().map(|spec| (spec, vec![setting.clone()])));
            // The base stands beside every one of them.
            wanted[0].1.push(setting);
        }
        let to_build: Vec<(Spec, &Lesson)> = wanted.iter().map(|&(spec, _)| (spec, &lesson)).collect();
        let built = lab.build(&to_build, found);
        let settings: Vec<Vec<Setting>> = wanted.into_iter().map(|(_, settings)| settings).collect();
        lab.measure(&entrants(&built, &settings), &lab.rays(&view, mode), found);
        Ok(())
    }
}

fn variants() -> Vec<(String, Setting)> {
    let weight = |w: &f64| (format!("kd+rdh(paper,weight={w})"), Setting::at(format!("weight of the rays {w}"), *w));
    let prior = |p: &f64| (format!("kd+rdh(prior={p})"), Setting::at(format!("areas worth {p} rays"), *p));
    WEIGHTS.iter().map(weight).chain(PRIORS.iter().map(prior)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variant_is_a_spec_and_stands_alone_in_its_setting() {
        let all = variants();
        assert!(all.iter().all(|(text, _)| specs(text).is_ok_and(|s| s.len() == 1)));
        assert!(all.iter().enumerate().all(|(i, (_, s))| all[..i].iter().all(|(_, other)| other != s)));
    }
}
