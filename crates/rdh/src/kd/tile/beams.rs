//! The beams around a tile's packets, side by side: where their rays may meet a plane first and last.
//!
//! Interval arithmetic (`tile/interval.rs`) as for the beam of `bvh/tile/beam.rs`; a lane a packet in place of a lane a box.

use crate::simd::{Eight, Floats, extremes};
use crate::tile::{Class, Interval, Lead, PACKETS, Reach};

/// What the rays of each packet reach.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beams<E> {
    axes: [Interval<E>; 3],
    /// Where their first rays begin.
    pub(super) start: E,
    /// Where their last rays end.
    pub(super) end: E,
}

impl<R: Floats> Lead<R> for Beams<R::Eight> {
    type Reaches = [Reach<R>; PACKETS];

    #[inline(always)]
    fn new(reaches: &[Reach<R>; PACKETS], class: Class) -> Self {
        let axes = [along(reaches, class, 0), along(reaches, class, 1), along(reaches, class, 2)];
        let [start, _] = extremes(reaches.each_ref().map(|reach| &reach.t_min));
        let [_, end] = extremes(reaches.each_ref().map(|reach| &reach.t_max));
        Self { axes, start, end }
    }
}

/// The packets' rays along an axis, a packet a lane.
#[inline(always)]
fn along<R: Floats>(reaches: &[Reach<R>; PACKETS], class: Class, axis: usize) -> Interval<R::Eight> {
    let [low, _] = extremes(reaches.each_ref().map(|reach| &reach.origin[axis].0));
    let [_, high] = extremes(reaches.each_ref().map(|reach| &reach.origin[axis].1));
    Interval::new(class, axis, [low, high], extremes(reaches.each_ref().map(|reach| &reach.inverse[axis].0)))
}

impl<E: Eight> Beams<E> {
    /// Where rays may meet a plane first, and where last.
    #[inline(always)]
    pub(super) fn meet(&self, axis: usize, plane: f32) -> (E, E) {
        let (along, plane) = (&self.axes[axis], E::splat(plane));
        (along.from(plane), along.until(plane))
    }
}
