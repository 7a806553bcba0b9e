//! Candidate planes of a node, with how many references lie on each side: at every bound (exact), or at
//! the outermost bounds in each bin.

use super::radix;
use super::reference::Reference;
use crate::geom::{Aabb, Axis};
use crate::simd::{Job, Kernels, Level};

/// The candidate planes of one axis, strictly inside the cell, in any order; parallel arrays.
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
    fn clear(&mut self) {
        self.planes.clear();
        self.left.clear();
        self.right.clear();
        self.flats_right_from = usize::MAX;
    }

    fn push(&mut self, plane: f32, left: u32, right: u32) {
        self.planes.push(plane);
        self.left.push(left);
        self.right.push(right);
    }

    /// Candidates with the flat references on the other side, given as (plane, left, right, flats).
    fn push_flats_right(&mut self, flats: &[(f32, u32, u32, u32)]) {
        self.flats_right_from = self.planes.len();
        for &(plane, left, right, flat) in flats {
            self.push(plane, left - flat, right + flat);
        }
    }
}

/// Finds candidates; keeps its buffers from node to node.
pub(crate) struct Events {
    level: Level,
    pub(crate) candidates: Candidates,
    lows: Vec<u32>,
    highs: Vec<u32>,
    flats: Vec<u32>,
    scratch: Vec<u32>,
    flat_planes: Vec<(f32, u32, u32, u32)>,
    few: Box<Few>,
    bins: Box<Bins>,
}

/// Up to so many references are counted against each other, without sorting.
pub(crate) const FEW: usize = 64;

/// The bounds of a few references, axis by axis.
struct Few {
    low: [[f32; FEW]; 3],
    high: [[f32; FEW]; 3],
}

/// Bins an axis.
const BINS: usize = 128;

/// How many lower and upper bounds fall into each bin, for all three axes, and the first and last of them: real bounds make
/// better planes than bins' borders (on a terrain 1.2 references a triangle instead of 1.7).
struct Bins {
    low: [[u32; BINS]; 3],
    high: [[u32; BINS]; 3],
    flat: [[u32; BINS]; 3],
    first_low: [[f32; BINS]; 3],
    last_high: [[f32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self {
        low: [[0; BINS]; 3],
        high: [[0; BINS]; 3],
        flat: [[0; BINS]; 3],
        first_low: [[f32::INFINITY; BINS]; 3],
        last_high: [[f32::NEG_INFINITY; BINS]; 3],
    };
}

impl Events {
    pub(crate) fn new(level: Level) -> Self {
        Self {
            level,
            candidates: Candidates::default(),
            lows: Vec::new(),
            highs: Vec::new(),
            flats: Vec::new(),
            scratch: Vec::new(),
            flat_planes: Vec::new(),
            few: Box::new(Few { low: [[0.0; FEW]; 3], high: [[0.0; FEW]; 3] }),
            bins: Box::new(Bins::EMPTY),
        }
    }

    fn push_tight_max(&mut self, a: usize, cell: &Aabb, tight: &Aabb, n: usize) {
        if tight.max[a] > cell.min[a] && tight.max[a] < cell.max[a] {
            self.candidates.push(tight.max[a], n as u32, 0);
        }
    }

    fn push_tight_min(&mut self, a: usize, cell: &Aabb, tight: &Aabb, n: usize) {
        if tight.min[a] > cell.min[a] && tight.min[a] < cell.max[a] {
            self.candidates.push(tight.min[a], 0, n as u32);
        }
    }

    /// Takes in a few references, for [`Self::sweep_few`].
    pub(crate) fn take_few(&mut self, refs: &[Reference]) {
        for (i, r) in refs.iter().enumerate() {
            for a in 0..3 {
                self.few.low[a][i] = r.min[a];
                self.few.high[a][i] = r.max[a];
            }
        }
    }

    /// Exact candidates of a few references: each plane is compared with each reference. O(n²), at most 64² lanes.
    /// Planes outside of the cell stay in the list, as ones that separate nothing.
    pub(crate) fn sweep_few(&mut self, axis: Axis, cell: &Aabb, n: usize) {
        let a = axis.index();
        let candidates = &mut self.candidates;
        candidates.clear();
        candidates.planes.extend_from_slice(&self.few.low[a][..n]);
        candidates.planes.extend_from_slice(&self.few.high[a][..n]);
        // Whole lanes: the rest repeats a plane.
        let lanes = (2 * n).next_multiple_of(8);
        candidates.planes.resize(lanes, self.few.high[a][n - 1]);
        candidates.left.resize(lanes, 0);
        candidates.right.resize(lanes, 0);
        let flats =
            self.level.run(CountFew { few: &self.few, candidates, axis: a, n, cell: [cell.min[a], cell.max[a]] });
        if flats {
            self.add_flats(a, n);
        }
    }

    /// Counts in what lies flat in a plane: first on the left, then in candidates of their own on the right.
    fn add_flats(&mut self, a: usize, n: usize) {
        self.flat_planes.clear();
        let candidates = &mut self.candidates;
        for (i, &plane) in candidates.planes.iter().enumerate() {
            let flat = self.few.count_flat(a, n, plane);
            let separates = candidates.left[i] < n as u32 || candidates.right[i] < n as u32;
            if flat > 0 && separates {
                candidates.left[i] += flat;
                self.flat_planes.push((plane, candidates.left[i], candidates.right[i], flat));
            }
        }
        candidates.push_flats_right(&self.flat_planes);
    }

    /// Exact candidates of many references: a plane at every bound. O(n), by radix sort.
    pub(crate) fn sweep_sorted(&mut self, refs: &[Reference], axis: Axis, cell: &Aabb) {
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
        self.candidates.clear();
        self.flat_planes.clear();
        let n = self.lows.len();
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
                self.candidates.push(plane, below + flat, above);
                if flat > 0 {
                    self.flat_planes.push((plane, below + flat, above, flat));
                }
            }
        }
        self.candidates.push_flats_right(&self.flat_planes);
    }

    /// Sorts all bounds into equal bins between the tight bounds, all axes in one pass. O(n).
    pub(crate) fn take_bins(&mut self, refs: &[Reference], tight: &Aabb) {
        self.level.run(FillBins { bins: &mut self.bins, refs, tight });
    }

    /// Binned candidates: the last upper and the first lower bound in each bin, and the tight bounds where they cut off
    /// empty space. An upper bound is counted exactly above, a lower one below; the other side up to its bin.
    pub(crate) fn sweep_bins(&mut self, axis: Axis, cell: &Aabb, tight: &Aabb, n: usize) {
        let a = axis.index();
        self.candidates.clear();
        self.push_tight_max(a, cell, tight, n);
        self.push_highs(a, tight, n);
        self.candidates.flats_right_from = self.candidates.planes.len();
        self.push_tight_min(a, cell, tight, n);
        self.push_lows(a, tight, n);
    }

    /// Planes at upper bounds: what lies flat in them ends there, and goes left.
    fn push_highs(&mut self, a: usize, tight: &Aabb, n: usize) {
        let bins = &self.bins;
        let (mut below, mut ended) = (0, 0);
        for k in 0..BINS {
            let plane = bins.last_high[a][k];
            ended += bins.high[a][k];
            let starts_here = if bins.first_low[a][k] >= plane { bins.flat[a][k] } else { bins.low[a][k] };
            if plane > tight.min[a] && plane < tight.max[a] {
                self.candidates.push(plane, below + starts_here, n as u32 - ended);
            }
            below += bins.low[a][k];
        }
    }

    /// Planes at lower bounds: what lies flat in them starts there, and goes right.
    fn push_lows(&mut self, a: usize, tight: &Aabb, n: usize) {
        let bins = &self.bins;
        let (mut below, mut ended) = (0, 0);
        for k in 0..BINS {
            let plane = bins.first_low[a][k];
            let ends_here = if bins.last_high[a][k] <= plane { bins.high[a][k] - bins.flat[a][k] } else { 0 };
            if plane > tight.min[a] && plane < tight.max[a] {
                self.candidates.push(plane, below, n as u32 - ended - ends_here);
            }
            below += bins.low[a][k];
            ended += bins.high[a][k];
        }
    }
}

impl Few {
    fn count_flat(&self, a: usize, n: usize, plane: f32) -> u32 {
        let pairs = self.low[a][..n].iter().zip(&self.high[a][..n]);
        pairs.filter(|&(&low, &high)| low == plane && high == plane).count() as u32
    }
}

/// Counts, for each bound of a few references, how many reach below it and how many above. Tells whether any is flat.
struct CountFew<'a> {
    few: &'a Few,
    candidates: &'a mut Candidates,
    axis: usize,
    n: usize,
    cell: [f32; 2],
}

impl Job for CountFew<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<K: Kernels>(self) -> bool {
        let Self { few, candidates, axis, n, cell } = self;
        let (low, high) = (&few.low[axis][..n], &few.high[axis][..n]);
        let (planes, left, right) = (&candidates.planes[..], &mut candidates.left[..], &mut candidates.right[..]);
        K::count_below(low, planes, left);
        K::count_up_to(high, planes, right);
        for ((&plane, left), right) in planes.iter().zip(left).zip(right) {
            let inside = plane > cell[0] && plane < cell[1];
            *left = if inside { *left } else { n as u32 };
            *right = if inside { n as u32 - *right } else { n as u32 };
        }
        low.iter().zip(high).fold(false, |any, (l, h)| any | (l == h))
    }
}

/// Counts the bounds in each bin.
struct FillBins<'a> {
    bins: &'a mut Bins,
    refs: &'a [Reference],
    tight: &'a Aabb,
}

impl Job for FillBins<'_> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        let Self { bins, refs, tight } = self;
        *bins = Bins::EMPTY;
        // Bins per unit of length; 0 on axes without extent.
        let scale = tight.extent().map(|e| if e > 0.0 { (BINS as f32 / e).min(f32::MAX) } else { 0.0 });
        let [x, y, z] = tight.min;
        let (first, scale) =
            ([x, y, z, 0.0, x, y, z, 0.0], [scale[0], scale[1], scale[2], 0.0, scale[0], scale[1], scale[2], 0.0]);
        for r in refs {
            let bin = K::bin(bytemuck::cast_ref(r), &first, &scale, BINS as i32 - 1);
            for a in 0..3 {
                let (low, high) = (bin[a] as usize % BINS, bin[a + 4] as usize % BINS);
                bins.low[a][low] += 1;
                bins.high[a][high] += 1;
                bins.flat[a][high] += u32::from(r.min[a] == r.max[a]);
                let (first, last) = (&mut bins.first_low[a][low], &mut bins.last_high[a][high]);
                *first = if r.min[a] < *first { r.min[a] } else { *first };
                *last = if r.max[a] > *last { r.max[a] } else { *last };
            }
        }
    }
}
