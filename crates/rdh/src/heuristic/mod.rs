//! What a split is expected to cost: the surface area heuristic, and heuristics that know the rays.

mod spec;

pub use spec::{Blend, HeuristicSpec, RayExtent, RdhSpec};
