//! The kd-tree's options as plain data.

use serde::{Deserialize, Serialize};

/// Parameters of a kd-tree.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct KdSpec {
    /// What a leaf's cost counts.
    pub leaf: LeafWidth,
    /// How split planes are searched.
    pub split: SplitSearch,
    /// What is done to subtrees that don't pay.
    pub prune: Prune,
    /// When a node is not split further.
    pub stop: Stop,
    /// A node of a few triangles in which a cast ray is expected to spend less than this (in units of a step, all cast
    /// rays together) stays a leaf; 0 splits it all the same. With a ray heuristic that is where no rays are traced.
    pub idle: f32,
}

impl KdSpec {
    /// `compact`: for a ray heuristic, a tree of half the memory, for rays like those that it knows no slower (docs/measurements.md).
    /// Others may take longer.
    pub const COMPACT: Self = Self {
        leaf: LeafWidth::Eight,
        split: SplitSearch::Binned,
        prune: Prune::ByHeuristic,
        stop: Stop::Auto,
        idle: 0.001,
    };
}

/// What a leaf's cost counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum LeafWidth {
    /// Every triangle: the textbook's cost.
    One,
    /// Every test of eight triangles at once, as the kernels run. Recommended.
    #[default]
    Eight,
}

/// How split planes are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum SplitSearch {
    /// At every bound of every clipped triangle: the best plane, O(N log N).
    Exact,
    /// At the bounds that bins find in large nodes, at all bounds in small ones: nearly as good and faster. Recommended.
    #[default]
    Binned,
}

/// What is done to subtrees that don't pay, once their true cost is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Prune {
    /// `area` for `sah` and `rdh(paper)`, `visits` for `rdh`.
    #[default]
    ByHeuristic,
    /// They stay.
    None,
    /// They become leaves where the areas of their nodes say that a leaf is cheaper.
    Area,
    /// They become leaves where the measured visits of their nodes say so.
    Visits,
}

/// When a node is not split further.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Stop {
    /// When no split is cheaper than the leaf.
    Cost,
    /// After two splits on the way down that don't pay: the second one may. Recommended, with pruning.
    #[default]
    Auto,
    /// Havran and Bittner 2002: depth 1.2 log2 N + 2, and 1 + 0.2 · depth failed splits on the way down, where a split fails if it does not
    /// bring the cost below 0.75 of the leaf's.
    Paper,
}
