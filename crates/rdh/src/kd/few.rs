//! Candidate planes of a few references: at every bound, each compared with each reference, without sorting.

use super::events::Candidates;
use super::reference::Reference;
use crate::geom::Aabb;
use crate::simd::{Job, Kernels, Level};

/// Up to so many references are counted against each other.
pub(crate) const FEW: usize = 64;

/// The bounds of a few references, axis by axis.
pub(crate) struct Few {
    n: usize,
    low: [[f32; FEW]; 3],
    high: [[f32; FEW]; 3],
}

impl Few {
    pub(crate) const EMPTY: Self = Self { n: 0, low: [[0.0; FEW]; 3], high: [[0.0; FEW]; 3] };

    /// Takes in references, at most [`FEW`].
    pub(crate) fn take(&mut self, refs: &[Reference]) {
        self.n = refs.len().min(FEW);
        for (i, r) in refs[..self.n].iter().enumerate() {
            for a in 0..3 {
                self.low[a][i] = r.min[a];
                self.high[a][i] = r.max[a];
            }
        }
    }

    /// Each bound's plane. O(n²), at most 64² lanes. Planes outside of the cell stay in the list, as ones that separate nothing.
    pub(crate) fn sweep(&self, level: Level, axis: usize, cell: &Aabb, candidates: &mut Candidates) {
        let n = self.n;
        let (low, high) = (&self.low[axis][..n], &self.high[axis][..n]);
        // Whole lanes: the rest repeats a plane.
        candidates.lengthen(2 * n, high[n - 1]);
        let (planes, _, _) = candidates.parts(0..2 * n);
        planes[..n].copy_from_slice(low);
        planes[n..].copy_from_slice(high);
        let cell = [cell.min[axis], cell.max[axis]];
        if level.run(Count { low, high, cell, candidates }) {
            self.add_flats(axis, candidates);
        }
    }

    /// Counts in what lies flat in a plane: first on the left, then in candidates of their own on the right.
    fn add_flats(&self, axis: usize, candidates: &mut Candidates) {
        let n = self.n as u32;
        let first = candidates.len();
        let (mut all_flat, mut count) = ([0.0; FEW], 0);
        for (&low, &high) in self.low[axis][..self.n].iter().zip(&self.high[axis][..self.n]) {
            all_flat[count] = low;
            count += usize::from(low == high);
        }
        let all_flat = &all_flat[..count];
        let mut flats = [(0.0, 0, 0, 0); 2 * FEW + 8];
        let mut found = 0;
        let (planes, left, right) = candidates.parts(0..first);
        for ((&plane, left), &right) in planes.iter().zip(left).zip(&*right) {
            let separates = *left < n || right < n;
            let flat = if separates { all_flat.iter().filter(|&&flat| flat == plane).count() as u32 } else { 0 };
            if flat > 0 {
                *left += flat;
                flats[found] = (plane, *left, right, flat);
                found += 1;
            }
        }
        candidates.push_flats_right(&flats[..found], n);
    }
}

/// Counts, for each bound, how many references reach below it and how many above. Tells whether any is flat.
struct Count<'a> {
    low: &'a [f32],
    high: &'a [f32],
    cell: [f32; 2],
    candidates: &'a mut Candidates,
}

impl Job for Count<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<K: Kernels>(self) -> bool {
        let Self { low, high, cell, candidates } = self;
        let n = low.len() as u32;
        let (planes, left, right) = candidates.parts(0..candidates.len());
        K::count_below(low, planes, left);
        K::count_up_to(high, planes, right);
        for ((&plane, left), right) in planes.iter().zip(left).zip(right) {
            let inside = plane > cell[0] && plane < cell[1];
            *left = if inside { *left } else { n };
            *right = if inside { n - *right } else { n };
        }
        low.iter().zip(high).fold(false, |any, (l, h)| any | (l == h))
    }
}
