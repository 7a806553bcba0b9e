//! What a study covers, from which each experiment takes its jobs.

use rdh_scene::Entry;

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
    /// Only scenes of at most so many triangles.
    pub triangles: usize,
    /// The same two in a quick study.
    pub quick: [usize; 2],
}

impl Sample {
    /// Everything; quickly: the first view of small scenes.
    pub const ALL: Self = Self { views: usize::MAX, triangles: usize::MAX, quick: [1, 50_000] };
    /// Two views of every scene.
    pub const TWO: Self = Self { views: 2, ..Self::ALL };
    /// The first view of scenes of up to half a million triangles.
    pub const MEDIUM: Self = Self { views: 1, triangles: 500_000, quick: [1, 30_000] };
    /// The first view of scenes of up to 150,000 triangles, for what takes many trees.
    pub const SMALL: Self = Self { views: 1, triangles: 150_000, quick: [1, 20_000] };
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
        let most = if self.quick { sample.quick[1] } else { sample.triangles };
        self.entries.iter().filter(move |e| e.triangles <= most)
    }

    fn views(&self, entry: &Entry, sample: Sample) -> Vec<String> {
        let most = if self.quick { sample.quick[0] } else { sample.views };
        // A scene without a known view is looked at from outside.
        let names = entry.views.iter().map(|v| v.name.clone()).take(most).collect::<Vec<_>>();
        if names.is_empty() { vec!["overview".to_owned()] } else { names }
    }
}
