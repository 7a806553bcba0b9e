//! Candidate planes of a node, with how many references lie on each side: at every bound (exact), or at
//! the outermost bounds in each bin.

use std::ops::Range;

use super::bins::{Bins, Node};
use super::few::Few;
use super::reference::Reference;
use crate::error::Result;
use crate::geom::{Aabb, Axis};
use crate::mem::{reserve, reserve_all};
use crate::options::Watch;
use crate::radix;
use crate::simd::Level;

/// The candidate planes of one axis, strictly inside the cell, in any order, and some that separate nothing; parallel arrays, whose
/// length is a multiple of eight.
#[derive(Default)]
pub(crate) struct Candidates {
    pub(crate) planes: Vec<f32>,
    /// References with a part on the left: the straddling ones count on both sides.
    pub(crate) left: Vec<u32>,
    /// References with a part on the right.
    pub(crate) right: Vec<u32>,
    /// From here on, what lies flat in the plane goes right; before, left.
    pub(crate) flats_right_from: usize,
}

impl Candidates {
    /// At least so many candidates, of which those that are not set are at `plane` and separate nothing of `n` references.
    #[inline(always)]
    pub(crate) fn reset(&mut self, len: usize, plane: f32, n: u32) {
        self.planes.clear();
        self.left.clear();
        self.right.clear();
        self.flats_right_from = usize::MAX;
        self.resize(len, plane, n);
    }

    /// At least so many candidates, all of which are yet to be set but for those at the end, whose planes are.
    #[inline(always)]
    pub(crate) fn lengthen(&mut self, len: usize, plane: f32) {
        self.flats_right_from = usize::MAX;
        self.planes.truncate(len);
        self.resize(len, plane, 0);
    }

    /// Makes room for as many in all: those that lie flat in a plane may be listed twice, each time rounded up.
    fn reserve(&mut self, len: usize) -> Result<()> {
        let len = len + 16;
        reserve_all(&mut self.planes, len, "split candidates")?;
        reserve_all(&mut self.left, len, "split candidates")?;
        reserve_all(&mut self.right, len, "split candidates")
    }

    #[inline(always)]
    fn resize(&mut self, len: usize, plane: f32, n: u32) {
        let len = len.next_multiple_of(8);
        self.planes.resize(len, plane);
        self.left.resize(len, n);
        self.right.resize(len, n);
    }

    pub(crate) fn len(&self) -> usize {
        self.planes.len()
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, plane: f32, left: u32, right: u32) {
        (self.planes[i], self.left[i], self.right[i]) = (plane, left, right);
    }

    /// Planes, and how much lies on their left and on their right.
    #[inline(always)]
    pub(crate) fn parts(&mut self, range: Range<usize>) -> (&mut [f32], &mut [u32], &mut [u32]) {
        (&mut self.planes[range.clone()], &mut self.left[range.clone()], &mut self.right[range])
    }

    /// Candidates with the flat references on the other side, given as (plane, left, right, flats), of `n` references.
    pub(crate) fn push_flats_right(&mut self, flats: &[(f32, u32, u32, u32)], n: u32) {
        let first = self.len();
        self.flats_right_from = first;
        let Some(&(plane, ..)) = flats.first() else { return };
        self.resize(first + flats.len(), plane, n);
        for (i, &(plane, left, right, flat)) in flats.iter().enumerate() {
            self.set(first + i, plane, left - flat, right + flat);
        }
    }
}

/// Finds candidates; keeps its buffers from node to node.
pub(crate) struct Events {
    level: Level,
    parallel: bool,
    pub(crate) candidates: Candidates,
    lows: Vec<u32>,
    highs: Vec<u32>,
    flats: Vec<u32>,
    scratch: Vec<u32>,
    found: Vec<(f32, u32, u32)>,
    flat_planes: Vec<(f32, u32, u32, u32)>,
    few: Box<Few>,
    bins: Box<Bins>,
}

impl Events {
    pub(crate) fn new(level: Level, parallel: bool) -> Self {
        Self {
            level,
            parallel,
            candidates: Candidates::default(),
            lows: Vec::new(),
            highs: Vec::new(),
            flats: Vec::new(),
            scratch: Vec::new(),
            found: Vec::new(),
            flat_planes: Vec::new(),
            few: Box::new(Few::EMPTY),
            bins: Box::new(Bins::EMPTY),
        }
    }

    /// Takes in a few references, for [`Self::sweep_few`].
    pub(crate) fn take_few(&mut self, refs: &[Reference]) {
        self.few.take(refs);
    }

    /// Exact candidates of a few references.
    pub(crate) fn sweep_few(&mut self, axis: Axis, cell: &Aabb) {
        self.few.sweep(self.level, axis.index(), cell, &mut self.candidates);
    }

    /// Takes in many references, for [`Self::sweep_bins`].
    pub(crate) fn take_bins(&mut self, refs: &[Reference], tight: &Aabb) {
        self.bins.fill(self.level, self.parallel, refs, tight);
    }

    /// Candidates that bins find.
    pub(crate) fn sweep_bins(&mut self, axis: Axis, cell: &Aabb, tight: &Aabb, n: usize) {
        let node = Node { axis: axis.index(), cell, tight, n: n as u32 };
        self.bins.sweep(self.level, &node, &mut self.candidates);
    }

    /// Exact candidates of many references: a plane at every bound. O(n), by radix sort.
    ///
    /// # Errors
    /// Lack of memory; cancellation, which is asked about before each list is sorted.
    pub(crate) fn sweep_sorted(
        &mut self,
        refs: &[Reference],
        axis: Axis,
        cell: &Aabb,
        watch: &Watch<'_>,
    ) -> Result<()> {
        let a = axis.index();
        for keys in [&mut self.lows, &mut self.highs, &mut self.flats, &mut self.scratch] {
            keys.clear();
            reserve(keys, refs.len(), "split candidates")?;
        }
        for r in refs {
            let (low, high) = (radix::key(r.min[a]), radix::key(r.max[a]));
            self.lows.push(low);
            self.highs.push(high);
            if low == high {
                self.flats.push(low);
            }
        }
        for keys in [&mut self.lows, &mut self.highs, &mut self.flats] {
            if keys.len() > Watch::STEPS {
                watch.check_cancelled()?;
            }
            radix::sort(keys, &mut self.scratch);
        }
        self.merge(radix::key(cell.min[a]), radix::key(cell.max[a]))
    }

    /// Walks the sorted bounds together: at each distinct one inside the cell, the numbers are the positions reached.
    fn merge(&mut self, cell_min: u32, cell_max: u32) -> Result<()> {
        self.found.clear();
        self.flat_planes.clear();
        let n = self.lows.len();
        reserve(&mut self.found, 2 * n, "split candidates")?;
        reserve(&mut self.flat_planes, self.flats.len(), "split candidates")?;
        let (mut low, mut high, mut flat) = (0, 0, 0);
        while low < n || high < n {
            let next = |keys: &[u32], i: usize| keys.get(i).copied().unwrap_or(u32::MAX);
            let plane = next(&self.lows, low).min(next(&self.highs, high));
            let (below, flats_before) = (low as u32, flat);
            while next(&self.lows, low) == plane {
                low += 1;
            }
            while next(&self.highs, high) == plane {
                high += 1;
            }
            while next(&self.flats, flat) == plane {
                flat += 1;
            }
            if plane > cell_min && plane < cell_max {
                let (plane, above, flat) = (radix::value(plane), (n - high) as u32, (flat - flats_before) as u32);
                self.found.push((plane, below + flat, above));
                if flat > 0 {
                    self.flat_planes.push((plane, below + flat, above, flat));
                }
            }
        }
        let filler = self.found.first().map_or(0.0, |found| found.0);
        self.candidates.reserve(self.found.len() + self.flat_planes.len())?;
        self.candidates.reset(self.found.len(), filler, n as u32);
        for (i, &(plane, left, right)) in self.found.iter().enumerate() {
            self.candidates.set(i, plane, left, right);
        }
        self.candidates.push_flats_right(&self.flat_planes, n as u32);
        Ok(())
    }
}
