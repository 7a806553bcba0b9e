//! The search for a cell's best split, by areas and by sampled rays, with footprints.
//!
//! Rays come in bundles: a bundle of `f` across visits a part of length `l` of a cell of length `L` with the chance
//! ```text
//! p = (l + f) / (L + f)                        by areas;  by rays: the share of those whose box of f meets the part
//! ```
//! Without the footprint a tree over parallel rays is cut down to pixels and never ends (its cells cost nothing); with it, cells that
//! are smaller than a bundle gain nothing from being cut.

use super::cell::Cell;
use super::rays::Places;

/// A cell is cut at one of so many lines less one, across each axis.
const BINS: usize = 16;

/// What steps and triangles cost a bundle, measured once and stored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Costs {
    /// A step through a node.
    pub(super) step: f32,
    /// A triangle in a leaf.
    pub(super) test: f32,
}

impl Costs {
    /// The stored constants.
    pub(super) const STORED: Self = Self { step: 0.5, test: 1.0 };

    /// What a leaf of `n` triangles costs.
    pub(super) fn leaf(&self, n: usize) -> f32 {
        self.test * n as f32
    }
}

/// A line across a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Split {
    pub(super) axis: usize,
    pub(super) at: f32,
    pub(super) cost: f32,
}

/// How much sampled rays count against areas: as many rays of weight 1 as areas stand for.
const PRIOR: f32 = 32.0;

/// The cheapest split of a cell in which so many boxes lie, if there is any.
pub(super) fn best(
    cell: &Cell,
    boxes: impl Iterator<Item = Cell> + Clone,
    places: &Places,
    foot: f32,
    costs: &Costs,
) -> Option<Split> {
    let mut best: Option<Split> = None;
    for axis in 0..2 {
        let Some(lines) = Lines::across(cell, axis) else { continue };
        let (left, right) = lines.count(boxes.clone());
        let (rays_left, rays_right) = lines.weigh(places, foot);
        let all = places.weight();
        let trust = all / (all + PRIOR);
        let length = cell.high[axis] - cell.low[axis];
        for i in 1..BINS {
            let at = lines.at(i);
            if !(at > cell.low[axis] && at < cell.high[axis]) {
                continue;
            }
            let chance = |part: f32, rays: f32| {
                let area = (part + foot) / (length + foot);
                if all > 0.0 { trust * (rays / all) + (1.0 - trust) * area } else { area }
            };
            let (p, q) = (chance(at - cell.low[axis], rays_left[i]), chance(cell.high[axis] - at, rays_right[i]));
            let cost = costs.step + p * costs.leaf(left[i] as usize) + q * costs.leaf(right[i] as usize);
            if best.is_none_or(|b| cost < b.cost) {
                best = Some(Split { axis, at, cost });
            }
        }
    }
    best
}

/// Evenly spaced lines across an axis of a cell: line `i` from 1 to `BINS` − 1.
struct Lines {
    axis: usize,
    low: f32,
    step: f32,
    per_step: f32,
}

impl Lines {
    /// None across a cell without an extent.
    fn across(cell: &Cell, axis: usize) -> Option<Self> {
        let (low, length) = (cell.low[axis], cell.high[axis] - cell.low[axis]);
        let (step, per_step) = (length / BINS as f32, BINS as f32 / length);
        (step > 1e-7 && per_step.is_finite()).then_some(Self { axis, low, step, per_step })
    }

    fn at(&self, i: usize) -> f32 {
        self.low + self.step * i as f32
    }

    /// Which bin a coordinate lies in.
    fn bin(&self, x: f32) -> usize {
        (((x - self.low) * self.per_step) as isize).clamp(0, BINS as isize - 1) as usize
    }

    /// How many boxes begin left of each line, and how many end right of it.
    fn count(&self, boxes: impl Iterator<Item = Cell>) -> ([u32; BINS], [u32; BINS]) {
        let (mut begin, mut end) = ([0u32; BINS], [0u32; BINS]);
        for b in boxes {
            begin[self.bin(b.low[self.axis])] += 1;
            end[self.bin(b.high[self.axis])] += 1;
        }
        (below(&begin), from(&end))
    }

    /// The weight of the rays whose boxes begin left of each line, and that of those which end right of it.
    fn weigh(&self, places: &Places, foot: f32) -> ([f32; BINS], [f32; BINS]) {
        let (mut begin, mut end) = ([0.0; BINS], [0.0; BINS]);
        for place in &places.0 {
            let x = place.at[self.axis];
            begin[self.bin(x - 0.5 * foot)] += place.weight;
            end[self.bin(x + 0.5 * foot)] += place.weight;
        }
        (below(&begin), from(&end))
    }
}

/// For each bin, the sum of those before it.
fn below<T: Copy + Default + std::ops::Add<Output = T>>(bins: &[T; BINS]) -> [T; BINS] {
    let (mut sums, mut sum) = ([T::default(); BINS], T::default());
    for (s, &bin) in sums.iter_mut().zip(bins) {
        *s = sum;
        sum = sum + bin;
    }
    sums
}

/// For each bin, the sum of it and those after it.
fn from<T: Copy + Default + std::ops::Add<Output = T>>(bins: &[T; BINS]) -> [T; BINS] {
    let (mut sums, mut sum) = ([T::default(); BINS], T::default());
    for (s, &bin) in sums.iter_mut().zip(bins).rev() {
        sum = sum + bin;
        *s = sum;
    }
    sums
}
