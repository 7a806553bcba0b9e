//! The builder: top-down, greedy, in O(N log N); then pruned bottom-up by the true cost of what grew.
//!
//! ```text
//! grow(references, cell):
//!     split = the cheapest candidate plane of any axis                                   (equation 1; `split.rs`)
//!     leaf, if the stop rule says so or a budget is spent                                             (`stop.rs`)
//!     cut the references at the plane; the sampled rays follow them                   (`reference.rs`, heuristic)
//!     grow both sides
//!     leaf after all, if that is cheaper than what has grown                                              (prune)
//! ```
//! Invariant: the builder sees boxes, a [`Clipper`] and a [`Heuristic`], never a mesh. The tree depends on nothing else: not on
//! threads, nor on time.

use rayon::prelude::*;

use super::branch::{Branch, Branches, Kept};
use super::cost::Costs;
use super::reference::Reference;
use super::spec::{KdSpec, Prune};
use super::split::{Search, Split};
use super::stop::{Failures, StopRule};
use crate::clip::{Clipper, Slice};
use crate::error::Result;
use crate::geom::Aabb;
use crate::heuristic::{Heuristic, NodeRays, Sah, SplitProbability};
use crate::mem::{joined, reserve};
use crate::options::{BuildOptions, Watch};
use crate::simd::Level;

/// Everything that stays the same for all nodes.
pub(crate) struct Builder<'a> {
    clipper: &'a dyn Clipper,
    heuristic: &'a dyn Heuristic,
    spec: KdSpec,
    costs: Costs,
    stop: StopRule,
    watch: Watch<'a>,
    parallel: bool,
    level: Level,
}

/// A node to be built.
struct Todo {
    cell: Aabb,
    /// The box of its references.
    tight: Aabb,
    rays: NodeRays,
    /// The chance that a ray which meets the tree's box visits it.
    chance: f32,
    depth: u32,
    failures: Failures,
    /// How many references its leaves may have.
    budget: usize,
}

/// A finished subtree: its root, and its expected cost for a ray that is in it.
#[derive(Debug, Clone, Copy)]
struct Grown {
    root: u32,
    cost: f32,
}

/// Subtrees of more references are built by two threads.
const PARALLEL_ABOVE: usize = 4096;
/// References that one thread cuts.
const CHUNK: usize = 1 << 13;
/// Subtrees of more references are not pruned: no leaf of that size pays.
const PRUNE_UP_TO: usize = 256;

impl<'a> Builder<'a> {
    pub(crate) fn new(
        clipper: &'a dyn Clipper,
        heuristic: &'a dyn Heuristic,
        spec: KdSpec,
        n: usize,
        options: &'a BuildOptions<'a>,
    ) -> Self {
        Self {
            clipper,
            heuristic,
            spec,
            costs: Costs::of(spec.leaf),
            stop: StopRule::new(&spec, n, options.max_depth),
            watch: Watch::new(options, n),
            parallel: options.threads != Some(1),
            level: options.level(),
        }
    }

    /// Builds the tree over some references; the root is the last node. `max_refs` is kept.
    pub(crate) fn build<K: Kept>(&self, refs: Vec<Reference>, cell: Aabb, max_refs: usize) -> Result<Branches<K>> {
        let rays = self.heuristic.root(&cell);
        let todo = Todo {
            tight: self.measure(&refs),
            cell,
            rays,
            chance: 1.0,
            depth: 0,
            failures: 0,
            budget: max_refs.max(refs.len()),
        };
        Ok(self.grow(refs, todo)?.0)
    }

    /// The box of some references. In their order: which of two zeros counts does not depend on threads.
    fn measure(&self, refs: &[Reference]) -> Aabb {
        let measure = |refs: &[Reference]| refs.iter().fold(Slice::EMPTY, |tight, r| tight.union(r.slice()));
        if !self.parallel {
            return measure(refs).bounds();
        }
        let chunks: Vec<Slice> = refs.par_chunks(CHUNK).map(measure).collect();
        chunks.into_iter().fold(Slice::EMPTY, Slice::union).bounds()
    }

    /// Large subtrees: both sides in parallel.
    fn grow<K: Kept>(&self, mut refs: Vec<Reference>, todo: Todo) -> Result<(Branches<K>, Grown)> {
        let mut search =
            Search::new(self.heuristic, self.costs, self.spec.split, (self.level, self.parallel), &self.watch);
        if !self.parallel || refs.len() <= PARALLEL_ABOVE {
            let mut branches = Branches::default();
            let grown = self.grow_in(&mut search, &mut branches, &mut refs, 0, todo)?;
            return Ok((branches, grown));
        }
        self.watch.check_cancelled()?;
        let Some((split, failures)) = self.choose(&mut search, &refs, &todo)? else {
            let mut branches = Branches::default();
            let leaf = self.leaf(&mut branches, &refs)?;
            return Ok((branches, leaf));
        };
        let (left, right, sides) = self.partition(refs, &split)?;
        let [todo_left, todo_right] = self.children(&todo, &split, failures, sides);
        let (l, r) = rayon::join(|| self.grow(left, todo_left), || self.grow(right, todo_right));
        let ((mut branches, l), (other, r)): ((Branches<K>, _), (Branches<K>, _)) = (l?, r?);
        let shift = branches.append(&other)?;
        let children = [l, Grown { root: r.root + shift, ..r }];
        let grown = self.join(&mut branches, &todo.cell, &split, children)?;
        Ok((branches, grown))
    }

    /// Small subtrees: one thread, all references on one stack. Those of this node lie from `start` to its top.
    fn grow_in<K: Kept>(
        &self,
        search: &mut Search<'_>,
        branches: &mut Branches<K>,
        stack: &mut Vec<Reference>,
        start: usize,
        todo: Todo,
    ) -> Result<Grown> {
        let n = stack.len() - start;
        if n > 1024 {
            self.watch.check_cancelled()?;
        }
        let Some((split, failures)) = self.choose(search, &stack[start..], &todo)? else {
            return self.leaf(branches, &stack[start..]);
        };
        let right_start = stack.len();
        let sides = self.partition_in(stack, start, &split)?;
        let [left, right] = self.children(&todo, &split, failures, sides);
        let mark = branches.mark();
        let r = self.grow_in(search, branches, stack, right_start, right)?;
        stack.truncate(start + sides[0].n);
        let l = self.grow_in(search, branches, stack, start, left)?;
        stack.truncate(start);
        let grown = self.join(branches, &todo.cell, &split, [l, r])?;
        if self.spec.prune == Prune::None || n > PRUNE_UP_TO || self.costs.leaf(n) > grown.cost {
            return Ok(grown);
        }
        let (root, count) = branches.collapse(mark)?;
        Ok(Grown { root, cost: self.costs.leaf(count) })
    }

    /// The split of a node, unless it is to be a leaf.
    fn choose(&self, search: &mut Search<'_>, refs: &[Reference], todo: &Todo) -> Result<Option<(Split, Failures)>> {
        if refs.len() <= 1 && self.costs.leaf(refs.len()) <= self.costs.traverse || todo.depth >= self.stop.max_depth {
            return Ok(None);
        }
        if self.stop.is_idle(&self.costs, refs.len(), todo.chance) {
            return Ok(None);
        }
        let Some(split) = search.best(refs, &todo.cell, &todo.tight, &todo.rays)? else { return Ok(None) };
        let Some(failures) = self.stop.go_on(&self.costs, refs.len(), split.cost, todo.failures) else {
            return Ok(None);
        };
        // Twice the references is the most that a split can need.
        let needed = if refs.len() * 2 <= todo.budget { 0 } else { count_sides(refs, &split) };
        Ok((needed <= todo.budget).then_some((split, failures)))
    }

    /// What the two sides of a split are to become.
    fn children(&self, todo: &Todo, split: &Split, failures: Failures, [left, right]: [Side; 2]) -> [Todo; 2] {
        let (cell_left, cell_right) = todo.cell.split(split.axis, split.plane);
        // `choose` has made sure that both sides fit.
        let spare = todo.budget.saturating_sub(left.n + right.n);
        // What is left of the budget goes where the references are; in integers, so that it never depends on threads.
        let spare_left = (spare as u128 * left.n as u128 / (left.n + right.n).max(1) as u128) as usize;
        let child = |side: Side, cell: Aabb, chance: f32, budget: usize| Todo {
            rays: self.heuristic.descend(&todo.rays, &cell),
            tight: side.tight,
            cell,
            chance: todo.chance * chance,
            depth: todo.depth + 1,
            failures,
            budget,
        };
        let SplitProbability { left: p, right: q } = split.chance;
        [child(left, cell_left, p, left.n + spare_left), child(right, cell_right, q, right.n + spare - spare_left)]
    }

    fn leaf<K: Kept>(&self, branches: &mut Branches<K>, refs: &[Reference]) -> Result<Grown> {
        self.watch.report(refs.len());
        Ok(Grown { root: branches.leaf(refs)?, cost: self.costs.leaf(refs.len()) })
    }

    /// An interior node over two finished children.
    fn join<K: Kept>(
        &self,
        branches: &mut Branches<K>,
        cell: &Aabb,
        split: &Split,
        children: [Grown; 2],
    ) -> Result<Grown> {
        let chance = if self.spec.prune == Prune::Area { area_chance(cell, split) } else { split.chance };
        let cost = self.costs.traverse + chance.left * children[0].cost + chance.right * children[1].cost;
        let chances = [split.chance.left, split.chance.right];
        let children = children.map(|c| c.root);
        let root = branches.push(Branch::Interior { axis: split.axis, plane: split.plane, children, chances })?;
        Ok(Grown { root, cost })
    }
}

/// One side of a partition.
#[derive(Clone, Copy)]
struct Side {
    /// How many references.
    n: usize,
    /// Their box.
    tight: Aabb,
}

impl Side {
    const NONE: Self = Self { n: 0, tight: Aabb::EMPTY };

    fn with(&self, other: &Self) -> Self {
        Self { n: self.n + other.n, tight: self.tight.union(&other.tight) }
    }
}

/// A side while references come to it.
struct Gathering {
    n: usize,
    tight: Slice,
}

impl Gathering {
    const fn new() -> Self {
        Self { n: 0, tight: Slice::EMPTY }
    }

    #[inline(always)]
    fn add(&mut self, r: &Reference) {
        self.n += 1;
        self.tight = self.tight.union(r.slice());
    }

    fn side(&self) -> Side {
        Side { n: self.n, tight: self.tight.bounds() }
    }
}

impl Builder<'_> {
    /// Cuts references in place: the left side stays, the right one goes to the end of the stack. No allocation a node.
    fn partition_in(&self, stack: &mut Vec<Reference>, start: usize, split: &Split) -> Result<[Side; 2]> {
        let end = stack.len();
        reserve(stack, end - start, "references")?;
        let (mut low, mut high) = (Gathering::new(), Gathering::new());
        for i in start..end {
            let r = stack[i];
            let (left, right) = match r.sides(split.axis, split.plane, split.flat_left) {
                (true, false) => {
                    stack[start + low.n] = r;
                    low.add(&r);
                    continue;
                }
                (false, _) => {
                    stack.push(r);
                    high.add(&r);
                    continue;
                }
                (true, true) => self.cut_straddler(r, split),
            };
            if let Some(left) = left {
                stack[start + low.n] = left;
                low.add(&left);
            }
            if let Some(right) = right {
                stack.push(right);
                high.add(&right);
            }
        }
        Ok([low.side(), high.side()])
    }

    /// Cuts references into two lists: large ones in chunks, on several threads.
    fn partition(&self, refs: Vec<Reference>, split: &Split) -> Result<(Vec<Reference>, Vec<Reference>, [Side; 2])> {
        if refs.len() <= CHUNK {
            let (mut left, mut right) = (refs, Vec::new());
            let sides = self.partition_in(&mut left, 0, split)?;
            reserve(&mut right, sides[1].n, "references")?;
            right.extend_from_slice(&left[left.len() - sides[1].n..]);
            left.truncate(sides[0].n);
            return Ok((left, right, sides));
        }
        let cut = |refs: &[Reference]| -> Result<_> {
            let mut stack = Vec::new();
            reserve(&mut stack, 2 * refs.len(), "references")?;
            stack.extend_from_slice(refs);
            let [left, right] = self.partition_in(&mut stack, 0, split)?;
            Ok((stack, [left, right]))
        };
        let chunks: Result<Vec<(Vec<Reference>, [Side; 2])>> = refs.par_chunks(CHUNK).map(cut).collect();
        let (stacks, sides): (Vec<_>, Vec<_>) = chunks?.into_iter().unzip();
        let lefts: Vec<_> = stacks.iter().zip(&sides).map(|(stack, [left, _])| &stack[..left.n]).collect();
        let rights: Vec<_> =
            stacks.iter().zip(&sides).map(|(stack, [_, right])| &stack[stack.len() - right.n..]).collect();
        let both = |k: usize| sides.iter().fold(Side::NONE, |all, sides| all.with(&sides[k]));
        let left = joined(&lefts, true, "references", |_, r| r)?;
        let right = joined(&rights, true, "references", |_, r| r)?;
        Ok((left, right, [both(0), both(1)]))
    }

    /// The parts of a reference on both sides of a split; one of them at least.
    fn cut_straddler(&self, r: Reference, split: &Split) -> (Option<Reference>, Option<Reference>) {
        let (left, right) = self.clipper.split(r.id, &r.bounds(), split.axis, split.plane);
        let part = |b: Aabb| (!b.is_empty()).then(|| Reference::new(r.id, &b));
        match (part(left), part(right)) {
            // Nothing on either side can only be rounding: a lost reference would be a hole.
            (None, None) => {
                let (left, right) = r.bounds().split(split.axis, split.plane);
                (Some(Reference::new(r.id, &left)), Some(Reference::new(r.id, &right)))
            }
            parts => parts,
        }
    }
}

/// How many references both sides of a split have together, before clipping drops any.
fn count_sides(refs: &[Reference], split: &Split) -> usize {
    let sides = |r: &Reference| r.sides(split.axis, split.plane, split.flat_left);
    refs.iter().map(sides).map(|(l, r)| usize::from(l) + usize::from(r)).sum()
}

/// The chances by areas, whatever heuristic chose the split.
fn area_chance(cell: &Aabb, split: &Split) -> SplitProbability {
    let (mut left, mut right) = ([0.0], [0.0]);
    Sah.sweep(&NodeRays::default(), cell, split.axis, &[split.plane], &mut left, &mut right);
    SplitProbability { left: left[0], right: right[0] }
}
