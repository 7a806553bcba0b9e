//! Spatial splits: planes between bins of space, into which references are chopped.

use super::extent::Extent;
use super::split::{Search, tests};
use crate::clip::{Clipper, Slice};
use crate::error::Result;
use crate::geom::{Aabb, Axis};
use crate::mem::reserve;
use crate::simd::{Four, Job, Kernels, Portable};

/// The most bins an axis gets.
const BINS: usize = 32;

/// A plane at which references are cut.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpatialSplit {
    axis: Axis,
    plane: f32,
    left: Extent,
    right: Extent,
    counts: [u32; 2],
    /// Half areas times tests, of both sides.
    pub(crate) cost: f32,
}

impl SpatialSplit {
    /// How many references it adds to `n`.
    pub(crate) fn added(&self, n: usize) -> usize {
        (self.counts[0] as usize + self.counts[1] as usize).saturating_sub(n)
    }

    /// The references on both sides; those that lie on both are cut, or stay whole where that is cheaper.
    pub(crate) fn part(&self, references: &[Extent], clipper: &impl Clipper) -> Result<(Vec<Extent>, Vec<Extent>)> {
        let (mut left, mut right) = (Vec::new(), Vec::new());
        reserve(&mut left, self.counts[0] as usize, "references")?;
        reserve(&mut right, self.counts[1] as usize, "references")?;
        for reference in references {
            let (l, r) = self.cut(reference, clipper);
            for (side, part) in [(&mut left, l), (&mut right, r)] {
                if let Some(part) = part {
                    reserve(side, 1, "references")?;
                    side.push(part);
                }
            }
        }
        Ok((left, right))
    }

    fn cut(&self, reference: &Extent, clipper: &impl Clipper) -> (Option<Extent>, Option<Extent>) {
        let (bounds, a) = (reference.bounds(), self.axis.index());
        if bounds.max[a] <= self.plane {
            return (Some(*reference), None);
        }
        if bounds.min[a] >= self.plane {
            return (None, Some(*reference));
        }
        match self.cheapest(reference) {
            Place::Left => (Some(*reference), None),
            Place::Right => (None, Some(*reference)),
            Place::Both => {
                let (l, r) = clipper.split(reference.link, &bounds, self.axis, self.plane);
                let part = |part: Aabb| (!part.is_empty()).then(|| Extent::new(&part, reference.link, reference.count));
                match (part(l), part(r)) {
                    // Rounding must not lose it.
                    (None, None) => (Some(*reference), None),
                    parts => parts,
                }
            }
        }
    }

    /// Unsplitting: whether a reference that lies on both sides had better stay whole.
    fn cheapest(&self, reference: &Extent) -> Place {
        let [l, r] = self.counts;
        let with = |side: &Extent| {
            let mut both = *side;
            both.grow::<Portable>(reference);
            both.half_area()
        };
        let (area_left, area_right) = (self.left.half_area(), self.right.half_area());
        let both = self.cost;
        let left = with(&self.left) * tests(l) + area_right * tests(r.saturating_sub(1));
        let right = area_left * tests(l.saturating_sub(1)) + with(&self.right) * tests(r);
        if both <= left && both <= right {
            Place::Both
        } else if left <= right {
            Place::Left
        } else {
            Place::Right
        }
    }
}

enum Place {
    Left,
    Right,
    Both,
}

/// A node's references, to be split in space.
pub(crate) struct Chop<'a, C> {
    pub(crate) references: &'a [Extent],
    pub(crate) extent: &'a Extent,
    pub(crate) clipper: &'a C,
}

/// References that one thread chops.
const CHUNK: usize = 1 << 13;

impl<C: Clipper> Chop<'_, C> {
    /// The cheapest spatial split, if there is one. O(n + cuts).
    pub(crate) fn best(&self, search: &Search) -> Option<SpatialSplit> {
        let mut best = None;
        for axis in Axis::ALL {
            let slabs = Slabs::new(&self.extent.bounds(), axis, self.references.len());
            if slabs.per_width.is_finite() {
                let bins = self.fill_all(search, &slabs);
                best = search.level.run(Cheapest { bins: &bins, slabs: &slabs, best });
            }
        }
        best
    }

    fn fill_all(&self, search: &Search, slabs: &Slabs) -> [Bin; BINS] {
        let &Self { references, clipper, extent } = self;
        if !search.parallel || references.len() <= 2 * CHUNK {
            return search.level.run(Fill { references, clipper, slabs });
        }
        let (low, high) = references.split_at(references.len() / 2);
        let half = |references| Self { references, extent, clipper }.fill_all(search, slabs);
        let (mut bins, others) = search.both(|| half(low), || half(high));
        // Minima and sums of integers: any order gives the same.
        for (bin, other) in bins.iter_mut().zip(&others) {
            bin.extent.grow::<Portable>(&other.extent);
            bin.entries += other.entries;
            bin.exits += other.exits;
        }
        bins
    }
}

/// Chops references along an axis.
struct Fill<'a, C> {
    references: &'a [Extent],
    clipper: &'a C,
    slabs: &'a Slabs,
}

/// Space between two planes: the box of the parts in it, how many references begin in it and how many end.
#[derive(Clone, Copy)]
struct Bin {
    extent: Extent,
    entries: u32,
    exits: u32,
}

impl Bin {
    /// Takes in a part between two planes across an axis, if there is any.
    #[inline(always)]
    fn grow<K: Kernels>(&mut self, part: Slice, axis: Axis, (from, to): (f32, f32)) {
        // Zeros lose their sign, as in `Extent::new`.
        let min = (part.min + Four::splat(0.0)).to_point();
        let negated_max = (Four::splat(0.0) - part.max).to_point();
        let mut extent = Extent { min, link: 0, negated_max, count: 0 };
        (extent.min[axis.index()], extent.negated_max[axis.index()]) = (from, 0.0 - to);
        if !extent.is_empty() {
            self.extent.grow::<K>(&extent);
        }
    }
}

/// A reference's box, in lanes.
#[inline(always)]
fn slice_of(reference: &Extent) -> Slice {
    Slice { min: Four::point(reference.min), max: Four::splat(0.0) - Four::point(reference.negated_max) }
}

impl<C: Clipper> Job for Fill<'_, C> {
    type Output = [Bin; BINS];

    #[inline(always)]
    fn run<K: Kernels>(self) -> [Bin; BINS] {
        let slabs = self.slabs;
        let mut bins = [Bin { extent: Extent::EMPTY, entries: 0, exits: 0 }; BINS];
        let a = slabs.axis.index();
        for reference in self.references {
            let (from, to) = (reference.min[a], -reference.negated_max[a]);
            let (first, last) = (slabs.bin_of(from), slabs.bin_of(to));
            bins[first].entries += 1;
            bins[last].exits += 1;
            if first == last {
                bins[first].extent.grow::<K>(reference);
                continue;
            }
            let (whole, slope) = (slice_of(reference), self.clipper.slope(reference.link, slabs.axis));
            let mut before = (from, slope.section(from));
            for (bin, slab) in bins[first..=last].iter_mut().zip(first..) {
                let plane = if slab == last { to } else { slabs.plane(slab) };
                let after = (plane, slope.section(plane));
                let part = slope.between(before, after).intersection(whole);
                bin.grow::<K>(part, slabs.axis, (before.0, plane));
                before = after;
            }
        }
        bins
    }
}

/// Slabs of equal width along an axis.
struct Slabs {
    axis: Axis,
    first: f32,
    width: f32,
    per_width: f32,
    count: usize,
}

impl Slabs {
    /// Few references need few slabs: each one that a reference spans costs a cut.
    fn new(bounds: &Aabb, axis: Axis, n: usize) -> Self {
        let count = (n / 8).next_power_of_two().clamp(8, BINS);
        let (first, last) = (bounds.min[axis.index()], bounds.max[axis.index()]);
        let width = (last - first) / count as f32;
        Self { axis, first, width, per_width: 1.0 / width, count }
    }

    #[inline(always)]
    fn bin_of(&self, x: f32) -> usize {
        (((x - self.first) * self.per_width) as usize).min(self.count - 1)
    }

    /// The plane behind a slab.
    #[inline(always)]
    fn plane(&self, slab: usize) -> f32 {
        self.first + (slab + 1) as f32 * self.width
    }
}

struct Cheapest<'a> {
    bins: &'a [Bin; BINS],
    slabs: &'a Slabs,
    best: Option<SpatialSplit>,
}

impl Job for Cheapest<'_> {
    type Output = Option<SpatialSplit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<SpatialSplit> {
        cheapest::<K>(self.bins, self.slabs, self.best)
    }
}

#[inline(always)]
fn cheapest<K: Kernels>(bins: &[Bin; BINS], slabs: &Slabs, mut best: Option<SpatialSplit>) -> Option<SpatialSplit> {
    let mut rights = [(Extent::EMPTY, 0); BINS];
    let (mut side, mut n) = (Extent::EMPTY, 0);
    for i in (1..slabs.count).rev() {
        side.grow::<K>(&bins[i].extent);
        n += bins[i].exits;
        rights[i - 1] = (side, n);
    }
    (side, n) = (Extent::EMPTY, 0);
    for (i, bin) in bins[..slabs.count - 1].iter().enumerate() {
        side.grow::<K>(&bin.extent);
        n += bin.entries;
        let (right, m) = rights[i];
        if n == 0 || m == 0 {
            continue;
        }
        let cost = side.half_area() * tests(n) + right.half_area() * tests(m);
        if best.is_none_or(|best| cost < best.cost) {
            best =
                Some(SpatialSplit { axis: slabs.axis, plane: slabs.plane(i), left: side, right, counts: [n, m], cost });
        }
    }
    best
}
