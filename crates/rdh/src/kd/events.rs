//! Candidate planes of a node, with how many references lie on each side: at every bound (exact) or at the borders of bins.

use super::radix;
use super::reference::Reference;
use crate::geom::{Aabb, Axis};

/// How many references lie on each side of a plane; what straddles it is on both.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Sides {
    /// Some part is strictly below the plane.
    pub(crate) below: u32,
    /// Some part is strictly above the plane.
    pub(crate) above: u32,
    /// Lies flat in the plane.
    pub(crate) flat: u32,
}

/// The candidate planes of one axis, ascending, strictly inside the cell.
#[derive(Default)]
pub(crate) struct Events {
    pub(crate) planes: Vec<f32>,
    pub(crate) sides: Vec<Sides>,
    lows: Vec<u32>,
    highs: Vec<u32>,
    flats: Vec<u32>,
    scratch: Vec<u32>,
    bins: Bins,
}

/// Bins an axis.
const BINS: usize = 128;

/// How many lower and upper bounds fall into each bin, for all three axes.
struct Bins {
    low: [[u32; BINS]; 3],
    high: [[u32; BINS]; 3],
}

impl Default for Bins {
    fn default() -> Self {
        Self { low: [[0; BINS]; 3], high: [[0; BINS]; 3] }
    }
}

impl Events {
    /// Exact candidates: a plane at every bound of every reference. O(n log n), O(n) for many references.
    pub(crate) fn sweep_bounds(&mut self, refs: &[Reference], axis: Axis, cell: &Aabb) {
        let a = axis.index();
        self.lows.clear();
        self.highs.clear();
        self.flats.clear();
        for r in refs {
            let (low, high) = (radix::key(r.min[a]), radix::key(r.max[a]));
            self.lows.push(low);
            self.highs.push(high);
            if low == high {
                self.flats.push(low);
            }
        }
        for keys in [&mut self.lows, &mut self.highs, &mut self.flats] {
            radix::sort(keys, &mut self.scratch);
        }
        self.merge(radix::key(cell.min[a]), radix::key(cell.max[a]));
    }

    /// Walks the sorted bounds together: at each distinct one inside the cell, the numbers are the positions reached.
    fn merge(&mut self, cell_min: u32, cell_max: u32) {
        self.planes.clear();
        self.sides.clear();
        let n = self.lows.len();
        let (mut low, mut high, mut flat) = (0, 0, 0);
        while low < n || high < n {
            let next = |keys: &[u32], i: usize| keys.get(i).copied().unwrap_or(u32::MAX);
            let plane = next(&self.lows, low).min(next(&self.highs, high));
            let below = low;
            while next(&self.lows, low) == plane {
                low += 1;
            }
            while next(&self.highs, high) == plane {
                high += 1;
            }
            let flats_before = flat;
            while next(&self.flats, flat) == plane {
                flat += 1;
            }
            if plane > cell_min && plane < cell_max {
                self.planes.push(radix::value(plane));
                let (below, above, flat) = (below as u32, (n - high) as u32, (flat - flats_before) as u32);
                self.sides.push(Sides { below, above, flat });
            }
        }
    }

    /// Sorts all bounds into equal bins between the tight bounds, all axes in one pass. O(n).
    pub(crate) fn bin(&mut self, refs: &[Reference], tight: &Aabb) {
        self.bins = Bins::default();
        let scale = bin_scale(tight);
        for r in refs {
            for a in 0..3 {
                self.bins.low[a][bin_of(r.min[a], tight.min[a], scale[a])] += 1;
                self.bins.high[a][bin_of(r.max[a], tight.min[a], scale[a])] += 1;
            }
        }
    }

    /// Binned candidates: the bins' borders, and the tight bounds themselves where they cut off empty space.
    pub(crate) fn sweep_bins(&mut self, axis: Axis, cell: &Aabb, tight: &Aabb, n: usize) {
        let a = axis.index();
        self.planes.clear();
        self.sides.clear();
        let n = n as u32;
        let (first, last) = (tight.min[a], tight.max[a]);
        if first > cell.min[a] && first < cell.max[a] {
            self.push(first, Sides { below: 0, above: n, flat: 0 });
        }
        let width = (last - first) / BINS as f32;
        let (mut below, mut ended) = (0, 0);
        for k in 1..BINS {
            below += self.bins.low[a][k - 1];
            ended += self.bins.high[a][k - 1];
            let plane = first + k as f32 * width;
            if plane > first && plane < last {
                self.push(plane, Sides { below, above: n - ended, flat: 0 });
            }
        }
        if last > first && last < cell.max[a] {
            self.push(last, Sides { below: n, above: 0, flat: 0 });
        }
    }

    fn push(&mut self, plane: f32, sides: Sides) {
        self.planes.push(plane);
        self.sides.push(sides);
    }
}

/// Bins per unit of length; 0 on axes without extent.
fn bin_scale(tight: &Aabb) -> [f32; 3] {
    tight.extent().map(|e| if e > 0.0 { (BINS as f32 / e).min(f32::MAX) } else { 0.0 })
}

#[inline(always)]
fn bin_of(x: f32, first: f32, scale: f32) -> usize {
    (((x - first) * scale) as usize).min(BINS - 1)
}
