//! What could any kd-tree gain? Optima over small lattices of planes, and a search from tree to tree where there are many.

mod contents;
mod lattice;
mod optimal;
mod shape;

pub use contents::{RayCounts, TriangleCounts};
pub use lattice::{Cell, Lattice};
pub use optimal::{Prices, Tree, greedy, optimal};
pub use shape::{Part, Segment};
