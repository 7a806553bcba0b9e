//! Where some rays may meet a plane first and last: interval arithmetic along one axis.
//!
//! I. Wald, S. Boulos, P. Shirley: Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies, ACM TOG 26(1), 2007,
//! section 3.2. That no rounding loses a hit is argued in docs/watertight.md, section 4.

use super::Class;
use crate::simd::Eight;

/// Origins and reciprocal directions of rays of a class along an axis: those of one beam in all lanes, or those of a beam in each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval<E> {
    /// From which origin a plane is nearest, …
    first: E,
    /// … and from which it is farthest.
    last: E,
    least: E,
    most: E,
}

impl<E: Eight> Interval<E> {
    /// Of rays whose origins and reciprocal directions lie between two numbers each.
    #[inline(always)]
    pub(crate) fn new(class: Class, axis: usize, [low, high]: [E; 2], [least, most]: [E; 2]) -> Self {
        let (first, last) = if class.near(axis) == 0 { (high, low) } else { (low, high) };
        Self { first, last, least, most }
    }

    /// The `t` from which on rays may meet planes.
    #[inline(always)]
    pub(crate) fn from(&self, planes: E) -> E {
        let along = planes.sub(self.first);
        along.mul(self.least).min(along.mul(self.most))
    }

    /// The `t` until which they may.
    #[inline(always)]
    pub(crate) fn until(&self, planes: E) -> E {
        let along = planes.sub(self.last);
        along.mul(self.least).max(along.mul(self.most))
    }
}
