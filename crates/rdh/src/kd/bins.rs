//! Candidate planes of many references: the outermost bounds in each of some equal bins.
//!
//! Real bounds make better planes than bins' borders: on a terrain 1.2 references a triangle instead of 1.7.

use rayon::prelude::*;

use super::events::Candidates;
use super::reference::Reference;
use crate::geom::{Aabb, larger, smaller};
use crate::simd::{Job, Kernels, Level};

/// The most bins an axis gets.
const MOST: usize = 128;
/// What smaller nodes get: their planes would cost more to compare than they are worth.
const FEWER: usize = 32;
/// Nodes of up to so many references are small.
const SMALL: usize = 512;
/// References that one thread sorts into bins.
const CHUNK: usize = 1 << 13;

/// How many lower and upper bounds fall into each bin, for all three axes, and the first and last of them.
pub(crate) struct Bins {
    count: usize,
    axes: [AxisBins; 3],
}

struct AxisBins {
    low: [u32; MOST],
    /// Upper bounds, and those of them that belong to what is flat: counted at once, as halves of a word.
    high: [u64; MOST],
    first_low: [f32; MOST],
    last_high: [f32; MOST],
}

impl AxisBins {
    const EMPTY: Self = Self {
        low: [0; MOST],
        high: [0; MOST],
        first_low: [f32::INFINITY; MOST],
        last_high: [f32::NEG_INFINITY; MOST],
    };

    #[inline(always)]
    fn clear(&mut self, count: usize) {
        self.low[..count].fill(0);
        self.high[..count].fill(0);
        self.first_low[..count].fill(f32::INFINITY);
        self.last_high[..count].fill(f32::NEG_INFINITY);
    }
}

impl Bins {
    pub(crate) const EMPTY: Self = Self { count: MOST, axes: [AxisBins::EMPTY; 3] };

    /// Sorts all bounds into equal bins between the tight bounds, all axes in one pass; large sets on several threads if they are to
    /// be. O(n).
    pub(crate) fn fill(&mut self, level: Level, parallel: bool, refs: &[Reference], tight: &Aabb) {
        self.count = if refs.len() <= SMALL { FEWER } else { MOST };
        if !parallel || refs.len() <= 2 * CHUNK {
            level.run(Fill { bins: self, refs, tight });
            return;
        }
        let count = self.count;
        let bins = |refs: &[Reference]| {
            let mut bins = Box::new(Self { count, ..Self::EMPTY });
            level.run(Fill { bins: &mut bins, refs, tight });
            bins
        };
        // Sums of integers, minima and maxima: any order gives the same.
        let all = refs.par_chunks(CHUNK).map(bins).reduce(|| Box::new(Self { count, ..Self::EMPTY }), Self::merged);
        *self = *all;
    }

    fn merged(mut self: Box<Self>, other: Box<Self>) -> Box<Self> {
        for (mine, theirs) in self.axes.iter_mut().zip(&other.axes) {
            for k in 0..MOST {
                mine.low[k] += theirs.low[k];
                mine.high[k] += theirs.high[k];
                mine.first_low[k] = smaller(mine.first_low[k], theirs.first_low[k]);
                mine.last_high[k] = larger(mine.last_high[k], theirs.last_high[k]);
            }
        }
        self
    }

    /// The last upper and the first lower bound in each bin, and the tight bounds where they cut off empty space. An upper bound is
    /// counted exactly above, a lower one below; the other side up to its bin. Empty bins stay in the list, as planes that separate
    /// nothing.
    pub(crate) fn sweep(&self, level: Level, node: &Node<'_>, candidates: &mut Candidates) {
        level.run(Sweep { bins: self, node, candidates });
    }
}

/// An axis of a node of `n` references.
pub(crate) struct Node<'a> {
    pub(crate) axis: usize,
    pub(crate) cell: &'a Aabb,
    pub(crate) tight: &'a Aabb,
    pub(crate) n: u32,
}

/// Counts the bounds in each bin.
struct Fill<'a> {
    bins: &'a mut Bins,
    refs: &'a [Reference],
    tight: &'a Aabb,
}

impl Job for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        let Self { bins: Bins { count, axes }, refs, tight } = self;
        axes.iter_mut().for_each(|axis| axis.clear(*count));
        // Bins per unit of length; 0 on axes without extent.
        let [x, y, z] = tight.extent().map(|e| if e > 0.0 { (*count as f32 / e).min(f32::MAX) } else { 0.0 });
        let scale = [x, y, z, 0.0, x, y, z, 0.0];
        let [x, y, z] = tight.min;
        let first = [x, y, z, 0.0, x, y, z, 0.0];
        for r in refs {
            let bin = K::bin(bytemuck::cast_ref(r), &first, &scale, *count as i32 - 1);
            for (a, bins) in axes.iter_mut().enumerate() {
                let (low, high) = (bin[a] as usize % MOST, bin[a + 4] as usize % MOST);
                bins.low[low] += 1;
                bins.high[high] += 1 + (u64::from(r.min[a] == r.max[a]) << 32);
                let (first, last) = (&mut bins.first_low[low], &mut bins.last_high[high]);
                *first = if r.min[a] < *first { r.min[a] } else { *first };
                *last = if r.max[a] > *last { r.max[a] } else { *last };
            }
        }
    }
}

struct Sweep<'a> {
    bins: &'a Bins,
    node: &'a Node<'a>,
    candidates: &'a mut Candidates,
}

impl Job for Sweep<'_> {
    type Output = ();

    /// Planes at upper bounds come first: what lies flat in them ends there, and goes left. What lies flat in a lower bound starts
    /// there, and goes right.
    #[inline(always)]
    fn run<K: Kernels>(self) {
        let Self { bins: Bins { count, axes }, node: &Node { axis: a, cell, tight, n }, candidates } = self;
        let (count, bins) = ((*count).min(MOST), &axes[a]);
        // Whole lanes: what is left over separates nothing.
        candidates.reset(2 * count + 8, tight.min[a], n);
        candidates.flats_right_from = count + 1;
        let inside = |plane: f32| plane > cell.min[a] && plane < cell.max[a];
        if inside(tight.max[a]) {
            candidates.set(count, tight.max[a], n, 0);
        }
        if inside(tight.min[a]) {
            candidates.set(2 * count + 1, tight.min[a], 0, n);
        }
        let (mut below, mut ended) = ([0; MOST], [0; MOST]);
        running(&bins.low[..count], &mut below[..count]);
        let (mut high, mut flat) = ([0; MOST], [0; MOST]);
        for (k, &both) in bins.high[..count].iter().enumerate() {
            (high[k], flat[k]) = (both as u32, (both >> 32) as u32);
        }
        running(&high[..count], &mut ended[..count]);
        let separates = |plane: f32| plane > tight.min[a] && plane < tight.max[a];
        let (highs, lows) = (0..count, count + 1..2 * count + 1);
        let (planes, left, right) = candidates.parts(highs);
        for k in 0..count {
            let plane = bins.last_high[k];
            let starts_here = if bins.first_low[k] >= plane { flat[k] } else { bins.low[k] };
            let (l, r) = (below[k] + starts_here, n - ended[k] - high[k]);
            (planes[k], left[k], right[k]) = if separates(plane) { (plane, l, r) } else { (tight.min[a], n, n) };
        }
        let (planes, left, right) = candidates.parts(lows);
        for k in 0..count {
            let plane = bins.first_low[k];
            let ends_here = if bins.last_high[k] <= plane { high[k] - flat[k] } else { 0 };
            let (l, r) = (below[k], n - ended[k] - ends_here);
            (planes[k], left[k], right[k]) = if separates(plane) { (plane, l, r) } else { (tight.min[a], n, n) };
        }
    }
}

/// For each count, the sum of those before it.
#[inline(always)]
fn running(counts: &[u32], sums: &mut [u32]) {
    let mut sum = 0;
    for (&count, before) in counts.iter().zip(sums) {
        *before = sum;
        sum += count;
    }
}
