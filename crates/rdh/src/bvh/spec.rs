//! The BVH's options as plain data.

use serde::{Deserialize, Serialize};

/// Parameters of a BVH.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct BvhSpec {
    /// How many children a node has at most.
    pub width: Width,
    /// How much work goes into the build.
    pub effort: Effort,
    /// Where primitives may be parted.
    pub split: SplitSearch,
    /// What parts the primitives.
    pub splitter: Splitter,
    /// What leaves hold of triangles.
    pub triangles: Triangles,
    /// When it is built.
    pub when: When,
}

/// How many children a node has at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Width {
    /// Two: for comparison with the literature.
    Two,
    /// Four.
    Four,
    /// Eight: one vector instruction tests all. Recommended.
    #[default]
    Eight,
}

/// How much work goes into the build.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Effort {
    /// Half the bins, large leaves: for scenes that change before many rays are cast.
    Quick,
    /// Recommended.
    #[default]
    Default,
    /// Nodes are moved about afterwards, where that makes the tree cheaper: for scenes that stay.
    High,
}

impl BvhSpec {
    /// Whether a hierarchy of this kind can grow where rays come.
    pub(crate) fn can_be_lazy(&self) -> bool {
        let Self { width, effort: _, split, splitter, triangles, when: _ } = *self;
        (width, split, splitter, triangles) == (Width::Eight, SplitSearch::Binned, Splitter::Objects, Triangles::Copied)
    }
}

/// What parts the primitives of the binary tree that wide nodes are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Splitter {
    /// Each primitive goes to one side, whole. Recommended.
    #[default]
    Objects,
    /// Primitives are cut where boxes would overlap: slower to build, larger, and faster to trace where triangles are large.
    Spatial,
    /// The cells of a kd-tree: primitives are cut at all of its planes. The heuristic chooses these.
    KdTree,
}

/// What leaves hold of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Triangles {
    /// Copies of their corners. Recommended.
    #[default]
    Copied,
    /// The indices of their vertices in the mesh: less memory, slower to trace. For eight children a node.
    Shared,
}

/// When a hierarchy is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum When {
    /// All of it before there are rays. Recommended.
    #[default]
    Ahead,
    /// Where rays come, when they come ([`lazy`](crate::lazy)): for scenes of which little is seen before they change. For eight
    /// children a node, without cut or shared triangles.
    OnDemand,
}

impl Width {
    /// The number of children.
    pub(crate) fn children(self) -> u32 {
        match self {
            Self::Two => 2,
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

/// Where the primitives of a node may be parted, along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum SplitSearch {
    /// Between bins of their centres: O(N log N), and nearly as good. Recommended.
    #[default]
    Binned,
    /// Between any two of them: O(N log² N). By areas alone: with a ray heuristic only where spatial splits are chosen by areas, too.
    Sweep,
}
