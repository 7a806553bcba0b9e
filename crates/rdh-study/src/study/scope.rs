//! What a study covers, from which each experiment takes its jobs.

use rdh_scene::Entry;
use rdh_scene::catalog::Source;

use super::record::Job;
use crate::integrate::Mode;

/// Scenes, modes, and how much time there is.
#[derive(Debug, Clone)]
pub struct Scope {
    /// The scenes, in order.
    pub entries: Vec<Entry>,
    /// The modes that are wanted; an experiment that needs another one has no jobs for it.
    pub modes: Vec<Mode>,
    /// A first look: small scenes, few views.
    pub quick: bool,
}

/// Which part of a scope an experiment takes.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// At most so many views of a scene, its first ones.
    pub views: usize,
    /// The same of a scene of more than [`Sample::LARGE`] triangles.
    pub large_views: usize,
    /// Of the embedded scenes only those of the quick set: some of each kind.
    pub few: bool,
    /// Only scenes of at most so many triangles.
    pub triangles: usize,
    /// The same in a quick study, which takes one view of each.
    pub quick_triangles: usize,
}

impl Sample {
    /// A scene of more triangles than this is large.
    pub const LARGE: usize = 500_000;
    /// All scenes with all their views, one of large ones.
    pub const ALL: Self =
        Self { views: usize::MAX, large_views: 1, few: false, triangles: usize::MAX, quick_triangles: 50_000 };
    /// All scenes with two views, one of large ones.
    pub const TWO: Self = Self { views: 2, large_views: 1, ..Self::ALL };
    /// The first view of scenes that are not large.
    pub const MEDIUM: Self = Self { views: 1, triangles: Self::LARGE, quick_triangles: 30_000, ..Self::ALL };
    /// The first view of a few scenes of up to 150,000 triangles, for what takes many trees.
    pub const FEW: Self = Self { few: true, triangles: 150_000, quick_triangles: 20_000, ..Self::MEDIUM };
}

impl Scope {
    /// An experiment's jobs over a sample: scene by scene, view by view, mode by mode, at frame 0.
    pub fn jobs(&self, experiment: &str, sample: Sample, modes: &[Mode]) -> Vec<Job> {
        let mut jobs = Vec::new();
        for entry in self.sampled(sample) {
            for view in self.views(entry, sample) {
                for &mode in modes.iter().filter(|m| self.modes.contains(m)) {
                    let (experiment, scene) = (experiment.to_owned(), entry.id.clone());
                    jobs.push(Job { experiment, scene, view: view.clone(), frame: 0, mode });
                }
            }
        }
        jobs
    }

    /// The scenes of a sample.
    pub fn sampled(&self, sample: Sample) -> impl Iterator<Item = &Entry> {
        let most = if self.quick { sample.quick_triangles } else { sample.triangles };
        let wanted = move |e: &&Entry| !sample.few || e.quick || matches!(e.source, Source::Files(_));
        self.entries.iter().filter(move |e| e.triangles <= most).filter(wanted)
    }

    fn views(&self, entry: &Entry, sample: Sample) -> Vec<String> {
        let most = match entry.triangles > Sample::LARGE {
            _ if self.quick => 1,
            true => sample.large_views,
            false => sample.views,
        };
        // A scene without a known view is looked at from outside.
        let names = entry.views.iter().map(|v| v.name.clone()).take(most).collect::<Vec<_>>();
        if names.is_empty() { vec!["overview".to_owned()] } else { names }
    }
}
