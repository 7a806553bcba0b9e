//! The search for a node's best split: every candidate plane of an axis in one sweep.

use super::cost::Costs;
use super::events::Events;
use super::reference::Reference;
use super::spec::SplitSearch;
use crate::geom::{Aabb, Axis};
use crate::heuristic::{Heuristic, NodeRays, SplitProbability};

/// A split, and what it is expected to cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Split {
    pub(crate) axis: Axis,
    pub(crate) plane: f32,
    /// Where primitives go that lie flat in the plane.
    pub(crate) flat_left: bool,
    /// Equation (1), with the children as leaves.
    pub(crate) cost: f32,
    pub(crate) chance: SplitProbability,
}

/// Looks for splits; keeps its buffers from node to node.
pub(crate) struct Search<'a> {
    heuristic: &'a dyn Heuristic,
    costs: Costs,
    search: SplitSearch,
    events: Events,
    chances: Vec<SplitProbability>,
}

impl<'a> Search<'a> {
    /// Nodes with more references are binned, if the spec allows it.
    const BINNED_ABOVE: usize = 64;

    pub(crate) fn new(heuristic: &'a dyn Heuristic, costs: Costs, search: SplitSearch) -> Self {
        Self { heuristic, costs, search, events: Events::default(), chances: Vec::new() }
    }

    /// The cheapest split of a node, if there is any plane that separates something. Equal costs: the first axis, the
    /// lowest plane. `tight` is the box of all references.
    pub(crate) fn best(&mut self, refs: &[Reference], cell: &Aabb, tight: &Aabb, rays: &NodeRays) -> Option<Split> {
        let binned = self.search == SplitSearch::Binned && refs.len() > Self::BINNED_ABOVE;
        if binned {
            self.events.bin(refs, tight);
        }
        let mut best: Option<Split> = None;
        for axis in Axis::ALL {
            if binned {
                self.events.sweep_bins(axis, cell, tight, refs.len());
            } else {
                self.events.sweep_bounds(refs, axis, cell);
            }
            self.evaluate(axis, cell, rays, refs.len() as u32, &mut best);
        }
        best
    }

    fn evaluate(&mut self, axis: Axis, cell: &Aabb, rays: &NodeRays, n: u32, best: &mut Option<Split>) {
        let planes = &self.events.planes;
        self.chances.clear();
        self.chances.resize(planes.len(), SplitProbability::default());
        self.heuristic.sweep(rays, cell, axis, planes, &mut self.chances);
        let mut least = best.map_or(f32::INFINITY, |b| b.cost);
        for (i, (&plane, &chance)) in planes.iter().zip(&self.chances).enumerate() {
            let sides = self.events.sides[i];
            let mut consider = |left: u32, right: u32, flat_left: bool| {
                if left >= n && right >= n {
                    return;
                }
                let cost = self.costs.split(chance, left, right);
                if cost < least {
                    least = cost;
                    *best = Some(Split { axis, plane, flat_left, cost, chance });
                }
            };
            consider(sides.below + sides.flat, sides.above, true);
            if sides.flat > 0 {
                consider(sides.below, sides.above + sides.flat, false);
            }
        }
    }
}
