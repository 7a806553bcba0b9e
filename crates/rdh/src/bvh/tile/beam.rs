//! All rays of a tile at once, as intervals: which of a node's boxes none of them meets.
//!
//! Interval arithmetic for packets as in I. Wald, S. Boulos, P. Shirley: Ray Tracing Deformable Scenes Using Dynamic Bounding Volume
//! Hierarchies, ACM TOG 26(1), 2007, section 3.2. Here it is eight boxes against one beam, not one box.

use crate::simd::{Boxes, Eight, Entered, Floats};
use crate::tile::{Class, Reach};

/// Intervals of origins and reciprocal directions, each end in all lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beam<E> {
    /// From which origin the planes that are met first are nearest, …
    first: [E; 3],
    /// … and from which the others are farthest.
    last: [E; 3],
    least: [E; 3],
    most: [E; 3],
    t_min: E,
    t_max: E,
    class: Class,
}

impl<E: Eight> Beam<E> {
    /// Of rays of a class.
    #[inline(always)]
    pub(super) fn new<R: Floats>(reach: &Reach<R>, class: Class) -> Self {
        let zero = E::splat(0.0);
        let mut beam = Self {
            first: [zero; 3],
            last: [zero; 3],
            least: [zero; 3],
            most: [zero; 3],
            t_min: E::splat(lowest(&reach.t_min)),
            t_max: E::splat(highest(&reach.t_max)),
            class,
        };
        for a in 0..3 {
            let (low, high) = (E::splat(lowest(&reach.origin[a].0)), E::splat(highest(&reach.origin[a].1)));
            (beam.first[a], beam.last[a]) = if class.near(a) == 0 { (high, low) } else { (low, high) };
            beam.least[a] = E::splat(lowest(&reach.inverse[a].0));
            beam.most[a] = E::splat(highest(&reach.inverse[a].1));
        }
        beam
    }

    /// Where its last ray ends.
    #[inline(always)]
    pub(super) fn end(&self) -> f32 {
        self.t_max.lane(0)
    }

    /// Ends it where the last of the rays does.
    #[inline(always)]
    pub(super) fn end_at<R: Floats>(&mut self, ends: R) {
        self.t_max = E::splat(highest(&ends));
    }

    /// Which of the boxes some ray may meet, a bit a lane; `t` gets where the first one might enter them.
    #[inline(always)]
    pub(super) fn meet(&self, boxes: &Boxes<8>, t: &mut Entered<8>) -> u32 {
        let (mut near, mut far) = (self.t_min, self.t_max);
        for a in 0..3 {
            let side = self.class.near(a) & 1;
            let first = E::load(&boxes.planes[side][a]).sub(self.first[a]);
            let last = E::load(&boxes.planes[side ^ 1][a]).sub(self.last[a]);
            near = near.max(first.mul(self.least[a]).min(first.mul(self.most[a])));
            far = far.min(last.mul(self.least[a]).max(last.mul(self.most[a])));
        }
        t.0 = *near.lanes();
        near.le(far).signs()
    }
}

#[inline(always)]
fn lowest<R: Floats>(x: &R) -> f32 {
    let mut lowest = f32::INFINITY;
    for i in 0..R::COUNT {
        let lane = x.lane(i);
        lowest = if lane < lowest { lane } else { lowest };
    }
    lowest
}

#[inline(always)]
fn highest<R: Floats>(x: &R) -> f32 {
    let mut highest = f32::NEG_INFINITY;
    for i in 0..R::COUNT {
        let lane = x.lane(i);
        highest = if lane > highest { lane } else { highest };
    }
    highest
}
