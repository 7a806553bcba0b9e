//! What could any kd-tree gain? Optima over small lattices of planes, and a search from tree to tree where there are many.

mod contents;
mod grow;
mod lattice;
mod optimal;
mod ratios;
mod search;
mod shape;
mod small;

pub use contents::{RayCounts, TriangleCounts};
pub use grow::{Cut, Grown, GrownKind, Room, grow, pay};
pub use lattice::{Cell, Lattice};
pub use optimal::{Prices, Tree, greedy, optimal};
pub use ratios::{Ratio, SEARCHED_UP_TO, SMALL_UP_TO, bounds};
pub use search::{Effort, search};
pub use shape::{Part, Segment};
pub use small::{Paid, SmallBound, SmallScene};
