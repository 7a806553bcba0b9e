//! Which form suits rays: seen from a few of them, so that it costs next to nothing. Answers don't depend on it.

use crate::geom::{Aabb, Ray, Vec3};

/// How far directions of a tile may be apart, in units of their largest component, …
const TURN: f32 = 0.25;
/// … and origins, in units of the structure's extent.
const SHIFT: f32 = 1.0 / 16.0;
/// If most neighbours' origins are farther apart than this, in the same units, rays have no order.
const JUMP: f32 = 1.0 / 64.0;

/// How large a structure is, to those who ask how far apart rays are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent(f32);

impl Extent {
    /// That of a box.
    pub(super) fn of(bounds: &Aabb) -> Self {
        Self((0..3).map(|a| bounds.max[a] - bounds.min[a]).fold(0.0, f32::max))
    }

    /// Whether rays probably stay together: by the first, the last, and two in between. What is no number stays with nobody.
    #[inline(always)]
    pub(super) fn is_coherent(self, rays: &[Ray], which: &[u32]) -> bool {
        let last = which.len() - 1;
        let ray = |i: usize| &rays[which[i] as usize];
        let some = [ray(0), ray(last / 3), ray(last - last / 3), ray(last)];
        let turn = spread(some.map(|ray| ray.direction));
        let shift = spread(some.map(|ray| ray.origin));
        turn <= TURN * size(some[0].direction) && shift <= SHIFT * self.0
    }

    /// Whether rays start here and there.
    pub(super) fn is_unordered(self, rays: &[Ray], which: &[u32]) -> bool {
        let step = (which.len() / SAMPLES).max(2);
        let pairs = which.windows(2).step_by(step).map(|pair| [pair[0], pair[1]].map(|i| rays[i as usize].origin));
        let (far, all) = pairs.fold((0, 0), |(far, all), [a, b]| {
            let apart = size([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
            (far + usize::from(apart > JUMP * self.0), all + 1)
        });
        2 * far > all
    }
}

/// So many neighbours are looked at.
const SAMPLES: usize = 16;

#[inline(always)]
fn size([x, y, z]: Vec3) -> f32 {
    x.abs().max(y.abs()).max(z.abs())
}

/// The largest difference on any axis; not a number if something isn't.
#[inline(always)]
fn spread([a, b, c, d]: [Vec3; 4]) -> f32 {
    let mut most = 0.0;
    for i in 0..3 {
        let differences = [a[i] - b[i], a[i] - c[i], a[i] - d[i], b[i] - c[i], b[i] - d[i], c[i] - d[i]];
        for difference in differences {
            let apart = difference.abs();
            // A comparison that is false for what is no number keeps it.
            most = if apart <= most { most } else { apart };
        }
    }
    most
}
