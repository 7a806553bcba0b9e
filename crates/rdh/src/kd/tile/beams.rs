//! The beams around a tile's packets, side by side: where their rays may meet a plane first and last.
//!
//! Interval arithmetic as for the beam of `bvh/tile/beam.rs`; a lane a packet in place of a lane a box.

use crate::simd::{Eight, Floats, extremes};
use crate::tile::{Class, PACKETS, Reach};

/// Intervals of origins and reciprocal directions, axis by axis (a fourth one, so that no index needs a check).
#[derive(Debug, Clone, Copy)]
pub(super) struct Beams<E> {
    /// From which origin a plane is nearest, …
    first: [E; 4],
    /// … and from which it is farthest.
    last: [E; 4],
    least: [E; 4],
    most: [E; 4],
    /// Where their first rays begin.
    pub(super) start: E,
    /// Where their last rays end.
    pub(super) end: E,
}

impl<E: Eight> Beams<E> {
    /// Around nothing.
    #[inline(always)]
    pub(super) fn none() -> Self {
        let zero = E::splat(0.0);
        let four = [zero; 4];
        Self { first: four, last: four, least: four, most: four, start: zero, end: zero }
    }

    /// Of packets of a class, by what each reaches.
    #[inline(always)]
    pub(super) fn new<R: Floats<Eight = E>>(reaches: &[Reach<R>; PACKETS], class: Class) -> Self {
        let mut beams = Self::none();
        for a in 0..3 {
            let [low, _] = extremes(reaches.each_ref().map(|reach| &reach.origin[a].0));
            let [_, high] = extremes(reaches.each_ref().map(|reach| &reach.origin[a].1));
            (beams.first[a], beams.last[a]) = if class.near(a) == 0 { (high, low) } else { (low, high) };
            [beams.least[a], beams.most[a]] = extremes(reaches.each_ref().map(|reach| &reach.inverse[a].0));
        }
        [beams.start, _] = extremes(reaches.each_ref().map(|reach| &reach.t_min));
        [_, beams.end] = extremes(reaches.each_ref().map(|reach| &reach.t_max));
        beams
    }

    /// Where rays may meet a plane first, and where last.
    #[inline(always)]
    pub(super) fn meet(&self, axis: usize, plane: f32) -> (E, E) {
        let (a, plane) = (axis & 3, E::splat(plane));
        let (first, last) = (plane.sub(self.first[a]), plane.sub(self.last[a]));
        let from = first.mul(self.least[a]).min(first.mul(self.most[a]));
        (from, last.mul(self.least[a]).max(last.mul(self.most[a])))
    }
}
