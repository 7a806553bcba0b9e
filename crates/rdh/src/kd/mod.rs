//! The kd-tree: an exact and a binned builder, pruning, 8-byte nodes, leaves of 8-wide blocks.

mod spec;

pub use spec::{KdSpec, LeafWidth, Prune, SplitSearch, Stop};
