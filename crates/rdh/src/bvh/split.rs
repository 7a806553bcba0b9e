//! Binned surface area heuristic over the primitives' centres: all three axes in one pass.
//!
//! Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies* (2007). A child of n primitives is charged for its tests
//! as they are run, eight at a time; half of that linearly, since steps of eight would hide most differences.

use super::extent::Extent;
use super::spec::SplitSearch;
use super::sweep::{self, Place};
use crate::options::Watch;
use crate::simd::{Job, Kernels, Level, Portable};

/// The most bins an axis gets.
const MAX_BINS: usize = 32;

/// Where primitives are parted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Split {
    pub(crate) border: Border,
    pub(crate) left: Extent,
    pub(crate) right: Extent,
    /// Half areas times tests, of both sides.
    pub(crate) cost: f32,
}

/// What says which primitives go left.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Border {
    /// Those whose centres lie in bins up to `bin`.
    Bin { grid: Grid, axis: usize, bin: i32 },
    /// Those whose places on the axis come up to `last`.
    Place { axis: usize, last: Place },
}

impl Border {
    /// Whether a primitive goes left. No closure: those lose the kernel's instruction set.
    #[inline(always)]
    fn has_left(&self, primitive: &Extent) -> bool {
        match self {
            Self::Bin { grid, axis, bin } => grid.is_up_to(primitive, axis % 3, *bin),
            Self::Place { axis, last } => Place::of(primitive, *axis).is_up_to(last),
        }
    }
}

/// How centres are put into bins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    first: [f32; 8],
    scale: [f32; 8],
    last: i32,
}

/// What is known of a set of primitives before it is split: the box of their doubled centres.
pub(crate) type Centres = Extent;

impl Grid {
    /// A grid over a box of doubled centres; nothing if they all coincide.
    fn over(centres: &Centres, n: usize, most: usize) -> Option<Self> {
        let bins = n.next_multiple_of(8).clamp(8, most);
        let bounds = centres.bounds();
        let (mut first, mut scale) = ([1.0; 8], [0.0; 8]);
        let mut wide = false;
        for a in 0..3 {
            let width = bounds.max[a] - bounds.min[a];
            // A shade less than the number of bins, so that the last centre falls into the last bin.
            let per_bin = bins as f32 * (1.0 - 1e-6) / width;
            (first[a], first[a + 4]) = (bounds.min[a], bounds.min[a]);
            if per_bin.is_finite() {
                (scale[a], scale[a + 4]) = (per_bin, per_bin);
                wide = true;
            }
        }
        wide.then_some(Self { first, scale, last: bins as i32 - 1 })
    }

    /// The bins of two primitives on three axes each; lanes 3 and 7 mean nothing.
    #[inline(always)]
    fn bins_of<K: Kernels>(&self, a: &Extent, b: &Extent) -> [i32; 8] {
        let ([ax, ay, az], [bx, by, bz]) = (a.doubled_centre(), b.doubled_centre());
        K::bin(&[ax, ay, az, 1.0, bx, by, bz, 1.0], &self.first, &self.scale, self.last)
    }

    /// Whether a primitive's bin on an axis comes up to one that is not the last: the same numbers, which are not negative, compared
    /// before they are rounded down.
    #[inline(always)]
    fn is_up_to(&self, primitive: &Extent, axis: usize, bin: i32) -> bool {
        let centre = primitive.min[axis] - primitive.negated_max[axis];
        (centre - self.first[axis]) * self.scale[axis] < (bin + 1) as f32
    }
}

/// Bins of all axes, a power of two each: boxes and numbers.
struct Bins<const N: usize = MAX_BINS> {
    boxes: [[Extent; N]; 3],
    counts: [[u32; N]; 3],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { boxes: [[Extent::EMPTY; N]; 3], counts: [[0; N]; 3] };

    #[inline(always)]
    fn add<K: Kernels>(&mut self, primitive: &Extent, bins: [i32; 3]) {
        for (a, bin) in bins.into_iter().enumerate() {
            let bin = bin as usize % N;
            self.boxes[a][bin].grow::<K>(primitive);
            self.counts[a][bin] += 1;
        }
    }

    #[inline(always)]
    fn merge<K: Kernels>(&mut self, other: &Self) {
        for a in 0..3 {
            for bin in 0..N {
                self.boxes[a][bin].grow::<K>(&other.boxes[a][bin]);
                self.counts[a][bin] += other.counts[a][bin];
            }
        }
    }
}

/// The boxes on both sides of the planes across an axis: `lows` grow from one to the next, `highs` shrink. Some of the first lows
/// and of the last highs may be empty.
pub(crate) struct Sides<'a> {
    pub(crate) lows: &'a [Extent],
    pub(crate) highs: &'a [Extent],
}

/// Boxes and numbers of all bins up to each one, in an order.
fn running(
    boxes: &[Extent],
    counts: &[u32],
    order: impl Iterator<Item = usize>,
) -> ([Extent; MAX_BINS], [u32; MAX_BINS]) {
    let (mut unions, mut sums) = ([Extent::EMPTY; MAX_BINS], [0; MAX_BINS]);
    let (mut union, mut sum) = (Extent::EMPTY, 0);
    for bin in order {
        union.grow::<Portable>(&boxes[bin]);
        sum += counts[bin];
        (unions[bin], sums[bin]) = (union, sum);
    }
    (unions, sums)
}

/// What a subtree of `n` primitives is taken to cost a ray that visits it. A tree costs less than its tests: the more it holds, the
/// more of it is missed. n^¾ by square roots, which are rounded alike everywhere.
fn subtree(n: u32) -> f32 {
    let root = tests(n).sqrt();
    root * root.sqrt()
}

/// What the tests of `n` primitives count in the cost of a split.
#[inline(always)]
pub(crate) fn tests(n: u32) -> f32 {
    // Signed, since that is what CPUs convert.
    0.5 * (((n + 7) >> 3) as i32 as f32 + n as i32 as f32 * 0.125)
}

/// Who knows whether to go on, if anybody does.
pub(crate) type Asked<'a> = Option<&'a Watch<'a>>;

/// Finds splits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search {
    pub(crate) level: Level,
    /// Whether large sets are put into bins by several threads.
    pub(crate) parallel: bool,
    /// Which places are compared.
    pub(crate) split: SplitSearch,
    /// The most bins an axis gets.
    pub(crate) bins: usize,
    /// A leaf has at most so many primitives, up to [`LANES`](crate::simd::LANES).
    pub(crate) leaf: usize,
}

/// Sets of more primitives are put into bins in chunks of this size.
const CHUNK: usize = 1 << 13;

impl Search {
    /// The cheapest split, unless all centres coincide. O(n) by bins, O(n log n) by sweeping, which asks whether to go on; if not
    /// there is no split.
    pub(crate) fn best(&self, primitives: &[Extent], centres: &Centres, asked: Asked<'_>) -> Option<Split> {
        if self.split == SplitSearch::Sweep {
            return sweep::best(self.level, self.is_shared(primitives), primitives, asked);
        }
        let grid = Grid::over(centres, primitives.len(), self.bins)?;
        if !self.is_shared(primitives) {
            // At once: most nodes are small, and bins need not be kept.
            return self.level.run(Find { primitives, grid });
        }
        self.level.run(Choose { bins: &self.bins(primitives, grid), grid })
    }

    /// Whether several threads put primitives into bins.
    fn is_shared(&self, primitives: &[Extent]) -> bool {
        self.parallel && primitives.len() > 2 * CHUNK
    }

    fn bins(&self, primitives: &[Extent], grid: Grid) -> Box<Bins> {
        if !self.is_shared(primitives) {
            return self.level.run(Fill { primitives, grid });
        }
        use rayon::prelude::*;
        let chunks = primitives.par_chunks(CHUNK).map(|primitives| self.level.run(Fill { primitives, grid }));
        // Minima and sums of integers: any order gives the same.
        let merged = |mut a: Box<Bins>, b: Box<Bins>| {
            a.merge::<Portable>(&b);
            a
        };
        chunks.reduce(|| Box::new(Bins::EMPTY), merged)
    }

    /// The cheapest split where the chances that a ray in the node visits what lies on each side come from `chances`: of the boxes of
    /// bins up to each one, which grow, and of those after it, which shrink. O(n).
    pub(crate) fn best_by(
        &self,
        primitives: &[Extent],
        centres: &Centres,
        mut chances: impl FnMut(&Sides<'_>, &mut [f32], &mut [f32]),
    ) -> Option<Split> {
        let grid = Grid::over(centres, primitives.len(), self.bins)?;
        let bins = self.bins(primitives, grid);
        let last = grid.last as usize;
        let (mut best_cost, mut best) = (f32::INFINITY, None);
        for axis in (0..3).filter(|&a| grid.scale[a] != 0.0) {
            let (lows, low_counts) = running(&bins.boxes[axis][..last], &bins.counts[axis][..last], 0..last);
            let (highs, high_counts) =
                running(&bins.boxes[axis][1..=last], &bins.counts[axis][1..=last], (0..last).rev());
            let (mut left, mut right) = ([0.0; MAX_BINS], [0.0; MAX_BINS]);
            chances(&Sides { lows: &lows[..last], highs: &highs[..last] }, &mut left[..last], &mut right[..last]);
            for bin in (0..last).filter(|&bin| low_counts[bin] > 0 && high_counts[bin] > 0) {
                let cost = left[bin] * subtree(low_counts[bin]) + right[bin] * subtree(high_counts[bin]);
                if cost < best_cost {
                    let border = Border::Bin { grid, axis, bin: bin as i32 };
                    let split = Split { border, left: lows[bin], right: highs[bin], cost };
                    (best_cost, best) = (cost, Some(split));
                }
            }
        }
        best
    }

    /// Parts primitives: how many go left, and the boxes of both sides' centres. O(n), in place. Large sets in halves, whatever the
    /// number of threads: the order of the primitives must not depend on it.
    pub(crate) fn part(&self, primitives: &mut [Extent], split: &Split) -> (usize, [Centres; 2]) {
        if primitives.len() <= 2 * CHUNK {
            return self.level.run(Part { primitives, split });
        }
        let half = primitives.len() / 2;
        let (low, high) = primitives.split_at_mut(half);
        let ((left, [mut a, mut b]), (more, [c, d])) =
            self.both(|| self.part(&mut low[..], split), || self.part(&mut high[..], split));
        // What the first half has on the right changes places with what the second half has on the left.
        let wrong = (half - left).min(more);
        low[left..left + wrong].swap_with_slice(&mut high[more - wrong..more]);
        a.grow::<Portable>(&c);
        b.grow::<Portable>(&d);
        (left + more, [a, b])
    }

    /// Does both, at once if several threads build.
    pub(crate) fn both<A: Send, B: Send>(&self, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
        if self.parallel { rayon::join(a, b) } else { (a(), b()) }
    }

    /// The box of some primitives, and that of their doubled centres.
    pub(crate) fn measure(&self, primitives: &[Extent]) -> (Extent, Centres) {
        if primitives.len() <= 2 * CHUNK {
            return self.level.run(Measure { primitives });
        }
        let (low, high) = primitives.split_at(primitives.len() / 2);
        let ((mut extent, mut centres), (a, b)) = self.both(|| self.measure(low), || self.measure(high));
        extent.grow::<Portable>(&a);
        centres.grow::<Portable>(&b);
        (extent, centres)
    }
}

struct Find<'a> {
    primitives: &'a [Extent],
    grid: Grid,
}

impl Job for Find<'_> {
    type Output = Option<Split>;

    /// Most nodes are small: what they don't need is not even cleared.
    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Split> {
        match self.grid.last {
            ..8 => self.find::<K, 8>(),
            8..16 => self.find::<K, 16>(),
            _ => self.find::<K, MAX_BINS>(),
        }
    }
}

impl Find<'_> {
    #[inline(always)]
    fn find<K: Kernels, const N: usize>(self) -> Option<Split> {
        let mut bins = Bins::<N>::EMPTY;
        fill::<K, N>(self.primitives, &self.grid, &mut bins);
        choose::<K, N>(&bins, &self.grid)
    }
}

struct Fill<'a> {
    primitives: &'a [Extent],
    grid: Grid,
}

impl Job for Fill<'_> {
    type Output = Box<Bins>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Box<Bins> {
        let mut bins = Box::new(Bins::EMPTY);
        fill::<K, MAX_BINS>(self.primitives, &self.grid, &mut bins);
        bins
    }
}

struct Choose<'a> {
    bins: &'a Bins,
    grid: Grid,
}

impl Job for Choose<'_> {
    type Output = Option<Split>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Split> {
        choose::<K, MAX_BINS>(self.bins, &self.grid)
    }
}

/// Of more primitives a bin every other one gets bins of its own: neighbours share bins, and had to wait for each other.
const ALTERNATE_ABOVE: usize = 16;

#[inline(always)]
fn fill<K: Kernels, const N: usize>(primitives: &[Extent], grid: &Grid, bins: &mut Bins<N>) {
    if primitives.len() > ALTERNATE_ABOVE * N {
        let mut others = Bins::EMPTY;
        fill_pairs::<K, N>(primitives, grid, bins, Some(&mut others));
        bins.merge::<K>(&others);
    } else {
        fill_pairs::<K, N>(primitives, grid, bins, None);
    }
}

/// Two primitives at a time; the second one goes into `others` if there are any.
#[inline(always)]
fn fill_pairs<K: Kernels, const N: usize>(
    primitives: &[Extent],
    grid: &Grid,
    bins: &mut Bins<N>,
    mut others: Option<&mut Bins<N>>,
) {
    let pairs = primitives.chunks_exact(2);
    if let [last] = pairs.remainder() {
        let b = grid.bins_of::<K>(last, last);
        bins.add::<K>(last, [b[0], b[1], b[2]]);
    }
    for pair in pairs {
        let b = grid.bins_of::<K>(&pair[0], &pair[1]);
        bins.add::<K>(&pair[0], [b[0], b[1], b[2]]);
        others.as_deref_mut().unwrap_or(bins).add::<K>(&pair[1], [b[4], b[5], b[6]]);
    }
}

/// The cheapest plane between bins that leaves something on both sides.
#[inline(always)]
fn choose<K: Kernels, const N: usize>(bins: &Bins<N>, grid: &Grid) -> Option<Split> {
    let last = (grid.last as usize).min(N - 1);
    let (mut best_cost, mut best) = (f32::INFINITY, None);
    for a in 0..3 {
        if grid.scale[a] == 0.0 {
            continue;
        }
        let (boxes, counts) = (&bins.boxes[a], &bins.counts[a]);
        // From the right: what a split after each bin would cost on its right side.
        let mut right_costs = [0.0; N];
        let (mut side, mut n) = (Extent::EMPTY, 0);
        for bin in (1..=last).rev() {
            side.grow::<K>(&boxes[bin]);
            n += counts[bin];
            right_costs[bin - 1] = if n == 0 { f32::NAN } else { side.half_area() * tests(n) };
        }
        (side, n) = (Extent::EMPTY, 0);
        for bin in 0..last {
            side.grow::<K>(&boxes[bin]);
            n += counts[bin];
            if n == 0 {
                continue;
            }
            // NaN where the right side is empty: no comparison with it holds.
            let cost = side.half_area() * tests(n) + right_costs[bin];
            if cost < best_cost {
                (best_cost, best) = (cost, Some((a, bin)));
            }
        }
    }
    let (axis, bin) = best?;
    let (mut left, mut right) = (Extent::EMPTY, Extent::EMPTY);
    for (i, b) in bins.boxes[axis][..=last].iter().enumerate() {
        if i <= bin { &mut left } else { &mut right }.grow::<K>(b);
    }
    let border = Border::Bin { grid: *grid, axis, bin: bin as i32 };
    Some(Split { border, left, right, cost: best_cost })
}

struct Part<'a> {
    primitives: &'a mut [Extent],
    split: &'a Split,
}

impl Job for Part<'_> {
    type Output = (usize, [Centres; 2]);

    /// Each primitive changes places with the first one on the right, which is then the left side's last one or stays where it came to:
    /// no branch, since where primitives go is hard to guess.
    #[inline(always)]
    fn run<K: Kernels>(self) -> (usize, [Centres; 2]) {
        let Self { primitives, split } = self;
        let (mut left, mut centres) = (0, [Centres::EMPTY; 2]);
        for i in 0..primitives.len() {
            let is_left = split.border.has_left(&primitives[i]);
            centres[usize::from(!is_left)].grow::<K>(&centre(&primitives[i]));
            primitives.swap(left, i);
            left += usize::from(is_left);
        }
        (left, centres)
    }
}

struct Measure<'a> {
    primitives: &'a [Extent],
}

impl Job for Measure<'_> {
    type Output = (Extent, Centres);

    #[inline(always)]
    fn run<K: Kernels>(self) -> (Extent, Centres) {
        let mut both = (Extent::EMPTY, Centres::EMPTY);
        for p in self.primitives {
            both.0.grow::<K>(p);
            both.1.grow::<K>(&centre(p));
        }
        both
    }
}

/// A primitive's doubled centre as a box.
#[inline(always)]
fn centre(primitive: &Extent) -> Centres {
    let [x, y, z] = primitive.doubled_centre();
    Extent { min: [x, y, z], link: 0, negated_max: [-x, -y, -z], count: 0 }
}
