//! Growing a side's tree: top-down, over cells of the picture.
//!
//! ```text
//! grow(triangles, cell):
//!     drop what lies behind a triangle that covers the whole cell
//!     leaf, if no split is cheaper or the budget is spent                                             (`split.rs`)
//!     send each triangle to the parts that its edges reach
//!     grow both
//! ```

use super::cell::Cell;
use super::rays::Places;
use super::split::{self, Costs};
use crate::error::Result;
use crate::mem::reserve;
use crate::options::Watch;
use crate::simd::Sight;

/// A triangle in a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reference {
    /// Which of the sights.
    pub(super) index: u32,
    /// No hit in the cell is nearer.
    pub(super) near: f32,
}

/// A grown tree.
#[derive(Debug)]
pub(super) enum Branch {
    /// Low side first.
    Split { axis: usize, at: f32, children: Box<[Branch; 2]> },
    /// Nearest first.
    Leaf(Vec<Reference>),
}

/// What stays the same for all cells.
pub(super) struct Grower<'a> {
    pub(super) sights: &'a [Sight],
    /// Their boxes.
    pub(super) boxes: &'a [Cell],
    /// The width of a bundle.
    pub(super) foot: f32,
    /// Whether what nobody sees is dropped.
    pub(super) drops_hidden: bool,
    pub(super) parallel: bool,
    pub(super) watch: &'a Watch<'a>,
}

/// A cell to be built.
pub(super) struct Todo {
    pub(super) cell: Cell,
    pub(super) refs: Vec<Reference>,
    pub(super) places: Places,
    pub(super) depth: u32,
    /// How many references its leaves may have.
    pub(super) budget: usize,
}

/// No tree is deeper, and so no stack.
pub(super) const DEEPEST: u32 = 40;
/// Cells of more references are built by two threads.
const PARALLEL_ABOVE: usize = 4096;

impl Grower<'_> {
    /// The tree of a cell.
    pub(super) fn grow(&self, mut todo: Todo) -> Result<Branch> {
        if todo.refs.len() > 1024 {
            self.watch.check_cancelled()?;
        }
        self.place(&todo.cell, &mut todo.refs);
        let Some(split) = self.choose(&todo) else { return Ok(self.leaf(todo.refs)) };
        let [low, high] = todo.cell.split(split.axis, split.at);
        let (left, right) = self.send(&todo, &split, &low, &high)?;
        let (n, m) = (left.len(), right.len());
        if n + m > todo.budget {
            return Ok(self.leaf(todo.refs));
        }
        let spare = todo.budget - n - m;
        let spare_left = (spare as u128 * n as u128 / (n + m).max(1) as u128) as usize;
        let child = |cell: Cell, refs: Vec<Reference>, budget: usize| {
            let places = todo.places.among(&cell, self.foot);
            Todo { cell, refs, places, depth: todo.depth + 1, budget }
        };
        let (left, right) = (child(low, left, n + spare_left), child(high, right, m + spare - spare_left));
        let parallel = self.parallel && todo.refs.len() > PARALLEL_ABOVE;
        drop(todo.refs);
        let (left, right) = if parallel {
            rayon::join(|| self.grow(left), || self.grow(right))
        } else {
            (self.grow(left), self.grow(right))
        };
        Ok(Branch::Split { axis: split.axis, at: split.at, children: Box::new([left?, right?]) })
    }

    /// Places triangles in depth within a cell, and drops what lies behind one that covers it.
    fn place(&self, cell: &Cell, refs: &mut Vec<Reference>) {
        let mut hidden = f64::NEG_INFINITY;
        for r in refs.iter_mut() {
            let (index, sight) = (r.index as usize, &self.sights[r.index as usize]);
            r.near = r.near.min((cell.nearness(sight).1 as f32).next_up());
            if self.drops_hidden && self.boxes[index].holds(cell) {
                hidden = cell.covered_by(sight).map_or(hidden, |nearness| hidden.max(nearness));
            }
        }
        refs.retain(|r| f64::from(r.near) >= hidden);
    }

    fn choose(&self, todo: &Todo) -> Option<split::Split> {
        if todo.depth >= DEEPEST || todo.refs.len() <= 2 {
            return None;
        }
        let costs = Costs::STORED;
        let boxes = todo.refs.iter().map(|r| self.boxes[r.index as usize]);
        let split = split::best(&todo.cell, boxes, &todo.places, self.foot, &costs)?;
        (split.cost < costs.leaf(todo.refs.len())).then_some(split)
    }

    /// The triangles of both parts.
    fn send(
        &self,
        todo: &Todo,
        split: &split::Split,
        low: &Cell,
        high: &Cell,
    ) -> Result<(Vec<Reference>, Vec<Reference>)> {
        let (mut left, mut right) = (Vec::new(), Vec::new());
        reserve(&mut left, todo.refs.len(), "references")?;
        for r in &todo.refs {
            let (b, sight) = (&self.boxes[r.index as usize], &self.sights[r.index as usize]);
            let (to_left, to_right) = (b.low[split.axis] <= split.at, b.high[split.axis] >= split.at);
            // What reaches over the line may do so beside the cell.
            let both = to_left && to_right;
            if to_left && (!both || low.may_see(sight)) {
                left.push(*r);
            }
            if to_right && (!both || high.may_see(sight)) {
                reserve(&mut right, 1, "references")?;
                right.push(*r);
            }
        }
        Ok((left, right))
    }

    fn leaf(&self, mut refs: Vec<Reference>) -> Branch {
        self.watch.report(refs.len());
        refs.sort_unstable_by(|a, b| b.near.total_cmp(&a.near).then(a.index.cmp(&b.index)));
        Branch::Leaf(refs)
    }
}
