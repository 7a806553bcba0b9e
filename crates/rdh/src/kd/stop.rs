//! When a node is not split further.

use super::cost::Costs;
use super::spec::{KdSpec, Stop};

/// The rule, with what it needs to know of the whole tree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StopRule {
    stop: Stop,
    /// No node lies deeper.
    pub(crate) max_depth: u32,
    /// So many failed splits on the way down are borne.
    max_failures: u32,
    /// Nodes that cost a cast ray less are not worth their splits.
    idle: f32,
}

/// How many splits above a node did not pay.
pub(crate) type Failures = u32;

impl StopRule {
    /// The deepest tree that traversal's stack can hold.
    pub(crate) const DEEPEST: u32 = 64;

    /// Idle nodes of more triangles are split all the same, so that a ray that comes after all pays a bounded price: 32 tests of eight.
    const IDLE_UP_TO: usize = 256;

    /// The rule for `n` triangles.
    pub(crate) fn new(spec: &KdSpec, n: usize, max_depth: Option<usize>) -> Self {
        let usual_depth = usual_depth(spec.stop, n);
        let max_failures = match spec.stop {
            Stop::Cost => 0,
            Stop::Auto => 1,
            Stop::Paper => (1.0 + 0.2 * usual_depth) as u32,
        };
        let max_depth = max_depth.map_or(usual_depth as u32, |d| d.min(64) as u32).min(Self::DEEPEST);
        Self { stop: spec.stop, max_depth, max_failures, idle: spec.idle }
    }

    /// Whether a node of `n` triangles, which a cast ray visits with some chance, is left as it is because nothing in it
    /// could save enough.
    pub(crate) fn is_idle(&self, costs: &Costs, n: usize, chance: f32) -> bool {
        n <= Self::IDLE_UP_TO && chance * costs.leaf(n) < self.idle
    }

    /// Whether a node of `n` triangles whose best split costs `split` is split all the same; with the failures its
    /// children start from.
    pub(crate) fn go_on(&self, costs: &Costs, n: usize, split: f32, failures: Failures) -> Option<Failures> {
        let leaf = costs.leaf(n);
        let pays = match self.stop {
            Stop::Cost | Stop::Auto => split < leaf,
            Stop::Paper => split < 0.75 * leaf,
        };
        let failures = failures + u32::from(!pays);
        // Looking ahead is for nodes in which more than one split is left to come.
        let hopeless = self.stop == Stop::Auto && !pays && costs.is_one_test(n);
        (failures <= self.max_failures && !hopeless).then_some(failures)
    }
}

/// How deep a tree over `n` triangles gets, unless told otherwise.
pub(crate) fn usual_depth(stop: Stop, n: usize) -> f64 {
    let log2 = f64::from(n.max(1).ilog2());
    match stop {
        Stop::Cost | Stop::Auto => 8.0 + 1.3 * log2,
        Stop::Paper => 1.2 * log2 + 2.0,
    }
}
