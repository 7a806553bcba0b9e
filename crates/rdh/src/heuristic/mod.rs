//! What a split is expected to cost: the surface area heuristic, and heuristics that know the rays.
//!
//! The greedy cost of splitting a node, and the one place where the heuristics differ (Bittner and Havran 2009, eq. 1):
//! ```text
//! C = c_t + p_L C_L + p_R C_R          p_L, p_R: the chance that a ray in the node visits the left, the right child
//! ```
//! Invariant: heuristics know boxes, planes and rays, never nodes, meshes or costs of leaves.

mod blend;
mod ranks;
mod rdh;
mod sah;
mod spec;

pub(crate) use ranks::Ranks;
pub use rdh::Rdh;
pub use sah::Sah;
pub use spec::{Blend, By, HeuristicSpec, RayExtent, RdhSpec, Stages};

use crate::geom::{Aabb, Axis};
use crate::rays::Training;
use crate::simd::Level;

/// The chances that a ray in a node visits its left and its right child. Their sum is at least 1 for a plane inside
/// the node, since a ray may visit both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SplitProbability {
    /// p_L of equation 1.
    pub left: f32,
    /// p_R of equation 1.
    pub right: f32,
}

/// The sampled rays alive in a node: opaque to builders, which only hand it down. Empty for heuristics without rays.
#[derive(Debug, Clone, Default)]
pub struct NodeRays {
    pub(crate) spans: Vec<Span>,
}

/// The part of one sampled ray that lies in a node.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Span {
    /// Which of the heuristic's rays.
    pub(crate) ray: u32,
    /// Where it enters the node.
    pub(crate) t_in: f32,
    /// Where it leaves the node.
    pub(crate) t_out: f32,
}

impl NodeRays {
    /// How many sampled rays are alive.
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// Whether none is.
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }
}

/// A cost model's seam: what a researcher implements to try another one. Asked in batches, an axis at a time.
pub trait Heuristic: Sync {
    /// The rays that meet the structure's box.
    fn root(&self, bounds: &Aabb) -> NodeRays;

    /// Those of a node's rays that meet one of its children.
    fn descend(&self, rays: &NodeRays, child: &Aabb) -> NodeRays;

    /// p_L and p_R of equation 1 for each of the `planes` across `axis` of a node, which come in any order, and twice where
    /// that suits the caller. All three slices have one length.
    fn sweep(&self, rays: &NodeRays, node: &Aabb, axis: Axis, planes: &[f32], left: &mut [f32], right: &mut [f32]);
}

/// The heuristic that a spec names, trained on some rays, which are counted with some instructions. `scale` is the factor of the
/// structure's space.
pub(crate) fn from_spec(spec: &HeuristicSpec, rays: &Training, scale: f32, level: Level) -> Box<dyn Heuristic> {
    match spec {
        HeuristicSpec::Sah => Box::new(Sah),
        HeuristicSpec::Rdh(spec) => Box::new(Rdh::new(spec, rays, scale).with_level(level)),
    }
}
