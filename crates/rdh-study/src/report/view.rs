//! The study as the report's sections see it.

use std::collections::BTreeSet;

use rdh::{HeuristicSpec, RdhSpec, Spec};

use super::About;
use super::pairs::{Pair, pairs};
use crate::study::Record;

/// Records, their pairs, and what is said about them.
#[derive(Debug)]
pub(super) struct Study<'r> {
    pub records: &'r [Record],
    pub about: &'r About,
    pairs: Vec<Pair<'r>>,
    /// Specs in the order of their series: ours, the paper's, others as they come.
    specs: Vec<Spec>,
}

/// Ours.
pub(super) fn ours() -> Spec {
    Spec { heuristic: HeuristicSpec::Rdh(RdhSpec::default()), ..Spec::default() }
}

/// The paper's heuristic in our builder.
pub(super) fn papers() -> Spec {
    Spec { heuristic: HeuristicSpec::Rdh(RdhSpec::PAPER), ..Spec::default() }
}

impl<'r> Study<'r> {
    pub(super) fn new(records: &'r [Record], about: &'r About) -> Self {
        let pairs = pairs(records);
        let mut specs = vec![ours(), papers()];
        for pair in &pairs {
            if !specs.contains(&pair.spec) {
                specs.push(pair.spec);
            }
        }
        Self { records, about, pairs, specs }
    }

    /// Names of the experiments, in order.
    pub(super) fn experiments(&self) -> BTreeSet<&'r str> {
        self.records.iter().map(|r| r.job.experiment.as_str()).collect()
    }

    pub(super) fn has(&self, experiment: &str) -> bool {
        self.records_of(experiment).next().is_some()
    }

    pub(super) fn records_of(&self, experiment: &str) -> impl Iterator<Item = &'r Record> {
        self.records.iter().filter(move |r| r.job.experiment == experiment)
    }

    /// Pairs of an experiment: per class, and in total.
    pub(super) fn pairs(&self, experiment: &str) -> Vec<&Pair<'r>> {
        self.pairs.iter().filter(|p| p.job.experiment == experiment).collect()
    }

    /// Pairs of an experiment over all classes of each job together.
    pub(super) fn totals(&self, experiment: &str) -> Vec<&Pair<'r>> {
        self.pairs(experiment).into_iter().filter(|p| p.class.is_none()).collect()
    }

    /// The pairs of the main table: tuned trees against the tuned base, per class and in total.
    pub(super) fn main(&self) -> Vec<&Pair<'r>> {
        let base = Spec::default();
        let of = |name| self.pairs(name).into_iter().filter(|p| p.base == base).collect::<Vec<_>>();
        let modes = of("modes");
        if modes.is_empty() { of("paper") } else { modes }
    }

    /// The main table's pairs of our own heuristic, in total.
    pub(super) fn ours(&self) -> Vec<&Pair<'r>> {
        self.main().into_iter().filter(|p| p.class.is_none() && p.spec == ours()).collect()
    }

    /// The mark and colour of a spec, the same in every figure.
    pub(super) fn series(&self, spec: &Spec) -> usize {
        self.specs.iter().position(|s| s == spec).unwrap_or(self.specs.len())
    }

    pub(super) fn scenes(&self) -> BTreeSet<&'r str> {
        self.records.iter().map(|r| r.job.scene.as_str()).collect()
    }

    pub(super) fn views(&self) -> BTreeSet<(&'r str, &'r str, u32)> {
        self.records.iter().map(|r| (r.job.scene.as_str(), r.job.view.as_str(), r.job.frame)).collect()
    }
}
