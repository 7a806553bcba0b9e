//! Which views are worth a picture: where most is gained among each kind of scene, and where most is lost.

use rdh_scene::Kind;

use super::pairs::{Metric, Pair, pairs};
use super::view::ours;
use super::words::{self, change_of};
use crate::integrate::Mode;
use crate::study::Record;

/// A view, and why it is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// In words.
    pub why: String,
}

/// Those in which trees are trained on the view that they are tested on.
const EXPERIMENTS: [&str; 3] = ["modes", "paper", "occlusion"];

/// Chooses by the steps of primary rays at rest, which are exact: equal records, equal choice.
pub fn views_to_show(records: &[Record]) -> Vec<Shown> {
    let all = pairs(records);
    let base = rdh::Spec::default();
    let trained_there = |p: &&Pair<'_>| EXPERIMENTS.contains(&p.job.experiment.as_str());
    let counts = |p: &&Pair<'_>| p.class.is_none() && p.job.mode == Mode::Primary && p.job.frame == 0;
    let candidates: Vec<&Pair<'_>> =
        all.iter().filter(trained_there).filter(counts).filter(|p| p.spec == ours() && p.base == base).collect();
    let mut shown: Vec<Shown> = Vec::new();
    let mut show = |pair: Option<&&Pair<'_>>, what: &str| {
        let Some((pair, ratio)) = pair.and_then(|p| Some((p, p.ratio(Metric::Steps)?))) else { return };
        if shown.iter().all(|s| (&s.scene, &s.view) != (&pair.job.scene, &pair.job.view)) {
            let why = format!("{what}: {}", change_of(ratio, Metric::Steps));
            shown.push(Shown { scene: pair.job.scene.clone(), view: pair.job.view.clone(), why });
        }
    };
    let steps = |p: &&&Pair<'_>| p.ratio(Metric::Steps).unwrap_or(1.0);
    for kind in [Kind::Dense, Kind::Interior, Kind::Open] {
        let best = candidates.iter().filter(|p| p.kind == kind).min_by(|a, b| steps(a).total_cmp(&steps(b)));
        show(best, &format!("the largest gain in steps among {} scenes", words::kind(kind)));
    }
    let worst = candidates.iter().max_by(|a, b| steps(a).total_cmp(&steps(b)));
    show(worst, "the least gain of all");
    shown
}
