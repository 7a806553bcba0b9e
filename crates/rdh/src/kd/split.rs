//! The search for a node's best split: every candidate plane of an axis in one sweep.

use super::cost::Costs;
use super::events::{Candidates, Events};
use super::few::FEW;
use super::reference::Reference;
use super::spec::SplitSearch;
use crate::error::Result;
use crate::geom::{Aabb, Axis};
use crate::heuristic::{Heuristic, NodeRays, SplitProbability};
use crate::mem::reserve_all;
use crate::options::Watch;
use crate::simd::{Job, Kernels, LANES, Level};

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
    level: Level,
    watch: &'a Watch<'a>,
    events: Events,
    left: Vec<f32>,
    right: Vec<f32>,
}

/// How a node's candidates are found.
#[derive(Clone, Copy, PartialEq, Eq)]
enum How {
    /// Counted against each other.
    Few,
    /// At the bounds that bins find.
    Binned,
    /// At all bounds, sorted.
    Sorted,
}

/// Nodes of up to so many references are searched exactly even where the spec says `binned`.
const EXACT_UP_TO: usize = 32;

impl<'a> Search<'a> {
    pub(crate) fn new(
        heuristic: &'a dyn Heuristic,
        costs: Costs,
        search: SplitSearch,
        (level, parallel): (Level, bool),
        watch: &'a Watch<'a>,
    ) -> Self {
        Self {
            heuristic,
            costs,
            search,
            level,
            watch,
            events: Events::new(level, parallel),
            left: Vec::new(),
            right: Vec::new(),
        }
    }

    fn how(&self, n: usize) -> How {
        match self.search {
            SplitSearch::Binned if n <= EXACT_UP_TO => How::Few,
            SplitSearch::Binned => How::Binned,
            SplitSearch::Exact if n <= FEW => How::Few,
            SplitSearch::Exact => How::Sorted,
        }
    }

    /// The cheapest split of a node, if there is any plane that separates something. Equal costs: the first axis, then
    /// the first candidate. `tight` is the box of all references.
    ///
    /// # Errors
    /// Where references are sorted: lack of memory, or cancellation.
    pub(crate) fn best(
        &mut self,
        refs: &[Reference],
        cell: &Aabb,
        tight: &Aabb,
        rays: &NodeRays,
    ) -> Result<Option<Split>> {
        let n = refs.len();
        if self.costs.is_one_test(n) {
            return Ok(self.best_cut(n, cell, tight, rays));
        }
        let how = self.how(n);
        match how {
            How::Few => self.events.take_few(refs),
            How::Binned => self.events.take_bins(refs, tight),
            How::Sorted => {}
        }
        let mut best: Option<Split> = None;
        for axis in Axis::ALL {
            match how {
                How::Few => self.events.sweep_few(axis, cell),
                How::Binned => self.events.sweep_bins(axis, cell, tight, n),
                How::Sorted => {
                    self.events.sweep_sorted(refs, axis, cell, self.watch)?;
                    self.make_room()?;
                }
            }
            self.evaluate(axis, cell, rays, n as u32, &mut best);
        }
        Ok(best)
    }

    /// For the chances of all candidates.
    fn make_room(&mut self) -> Result<()> {
        let len = self.events.candidates.len();
        reserve_all(&mut self.left, len, "split candidates")?;
        reserve_all(&mut self.right, len, "split candidates")
    }

    /// Where one test finishes the leaf, nothing but cutting off empty space can pay; what it pays is known exactly.
    fn best_cut(&self, n: usize, cell: &Aabb, tight: &Aabb, rays: &NodeRays) -> Option<Split> {
        let mut best: Option<Split> = None;
        for axis in Axis::ALL {
            let a = axis.index();
            let planes = [tight.max[a], tight.min[a]];
            let (mut left, mut right) = ([0.0; 2], [0.0; 2]);
            self.heuristic.sweep(rays, cell, axis, &planes, &mut left, &mut right);
            for (plane, full_side, i) in [(planes[0], left[0], 0), (planes[1], right[1], 1)] {
                let cost = self.costs.traverse + full_side * self.costs.leaf(n);
                if plane > cell.min[a] && plane < cell.max[a] && best.is_none_or(|b| cost < b.cost) {
                    let chance = SplitProbability { left: left[i], right: right[i] };
                    best = Some(Split { axis, plane, flat_left: i == 0, cost, chance });
                }
            }
        }
        best
    }

    fn evaluate(&mut self, axis: Axis, cell: &Aabb, rays: &NodeRays, n: u32, best: &mut Option<Split>) {
        let candidates = &self.events.candidates;
        let planes = &candidates.planes;
        self.left.resize(planes.len(), 0.0);
        self.right.resize(planes.len(), 0.0);
        self.heuristic.sweep(rays, cell, axis, planes, &mut self.left, &mut self.right);
        let chances = (&self.left[..], &self.right[..]);
        let Some((i, cost)) = self.level.run(Cheapest { costs: &self.costs, candidates, chances, n }) else { return };
        if best.is_none_or(|b| cost < b.cost) {
            let flats_right_from = candidates.flats_right_from;
            *best = Some(Split {
                axis,
                plane: planes[i],
                flat_left: i < flats_right_from,
                cost,
                chance: SplitProbability { left: self.left[i], right: self.right[i] },
            });
        }
    }
}

/// Finds the first of the cheapest candidates that separate anything.
struct Cheapest<'a> {
    costs: &'a Costs,
    candidates: &'a Candidates,
    chances: (&'a [f32], &'a [f32]),
    n: u32,
}

impl Job for Cheapest<'_> {
    type Output = Option<(usize, f32)>;

    /// Lane by lane, so that nothing waits for the last comparison; then the cheapest of the lanes.
    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<(usize, f32)> {
        let m = self.candidates.planes.len();
        let (left, right) = (&self.candidates.left[..m], &self.candidates.right[..m]);
        let (chance_left, chance_right) = (&self.chances.0[..m], &self.chances.1[..m]);
        let (mut costs, mut places) = ([f32::INFINITY; LANES], [0u32; LANES]);
        for start in (0..m / LANES * LANES).step_by(LANES) {
            let end = start + LANES;
            let (left, right) = (&left[start..end], &right[start..end]);
            let (chance_left, chance_right) = (&chance_left[start..end], &chance_right[start..end]);
            // Into new arrays: writing to some elements alone becomes masked stores, which take some CPUs dozens of cycles.
            let (mut costs_now, mut places_now) = ([0.0; LANES], [0; LANES]);
            for i in 0..LANES {
                let chance = SplitProbability { left: chance_left[i], right: chance_right[i] };
                let cost = self.costs.split(chance, left[i], right[i]);
                // Without branches, so that all lanes are done at once.
                let is_better = ((left[i] < self.n) | (right[i] < self.n)) & (cost < costs[i]);
                costs_now[i] = if is_better { cost } else { costs[i] };
                places_now[i] = if is_better { (start + i) as u32 } else { places[i] };
            }
            (costs, places) = (costs_now, places_now);
        }
        let (mut best, mut least) = (u32::MAX, f32::INFINITY);
        for (&cost, &place) in costs.iter().zip(&places) {
            if cost < least || (cost == least && place < best) {
                (least, best) = (cost, place);
            }
        }
        (least < f32::INFINITY).then_some((best as usize, least))
    }
}
