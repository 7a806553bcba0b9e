//! What could any kd-tree gain? Optima over small lattices of planes.

mod lattice;
mod optimal;

pub use lattice::{Cell, Lattice};
pub use optimal::{Prices, greedy, optimal};
