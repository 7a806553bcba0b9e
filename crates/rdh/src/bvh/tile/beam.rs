//! All rays of a tile at once, as intervals: which of a node's boxes none of them meets.
//!
//! Interval arithmetic for packets (`tile/interval.rs`), but for eight boxes against one beam, not one box.

use crate::simd::{Boxes, Eight, Entered, Floats, highest, lowest};
use crate::tile::{Class, Interval, Lead, Reach};

/// What all rays reach.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beam<E> {
    axes: [Interval<E>; 3],
    t_min: E,
    t_max: E,
    class: Class,
}

impl<R: Floats> Lead<R> for Beam<R::Eight> {
    type Reaches = Reach<R>;

    #[inline(always)]
    fn new(reach: &Reach<R>, class: Class) -> Self {
        let axes = [along(reach, class, 0), along(reach, class, 1), along(reach, class, 2)];
        let (t_min, t_max) = (lowest(&reach.t_min), highest(&reach.t_max));
        Self { axes, t_min: R::Eight::splat(t_min), t_max: R::Eight::splat(t_max), class }
    }
}

/// All rays along an axis, in all lanes.
#[inline(always)]
fn along<R: Floats>(reach: &Reach<R>, class: Class, axis: usize) -> Interval<R::Eight> {
    let ((low, high), (least, most)) = (&reach.origin[axis], &reach.inverse[axis]);
    let origin = [R::Eight::splat(lowest(low)), R::Eight::splat(highest(high))];
    Interval::new(class, axis, origin, [R::Eight::splat(lowest(least)), R::Eight::splat(highest(most))])
}

impl<E: Eight> Beam<E> {
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
            near = near.max(self.axes[a].from(E::load(&boxes.planes[side][a])));
            far = far.min(self.axes[a].until(E::load(&boxes.planes[side ^ 1][a])));
        }
        t.0 = *near.lanes();
        near.le(far).signs()
    }
}
