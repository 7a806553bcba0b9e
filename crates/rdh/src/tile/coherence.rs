//! Which form suits rays: seen from a few of them, so that it costs next to nothing. Answers don't depend on it.

use std::array;

use super::RAYS;
use crate::geom::{Aabb, Ray, Vec3};
use crate::simd::prefetch;

/// How far directions of a tile may be apart, in units of their largest component, …
const TURN: f32 = 0.25;
/// … or this far in parts of fewer rays: they are over before it turns out that tiles don't pay, …
const NARROW: (f32, usize) = (1.0 / 16.0, 4 * RAYS);
/// … and origins, in units of the structure's extent.
const SHIFT: f32 = 1.0 / 16.0;
/// If most neighbours' origins are farther apart than this, in units of how far apart any are, rays have no order.
const JUMP: f32 = 1.0 / 8.0;

/// How far apart rays of a tile may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    turn: f32,
    shift: f32,
}

impl Extent {
    /// For so many rays through a structure within a box.
    pub(crate) fn of(bounds: &Aabb, count: usize) -> Self {
        let extent = (0..3).map(|a| bounds.max[a] - bounds.min[a]).fold(0.0, f32::max);
        Self { turn: if count < NARROW.1 { NARROW.0 } else { TURN }, shift: SHIFT * extent }
    }

    /// Whether rays probably stay together: by the first, the last, and two in between. What is no number stays with nobody.
    #[inline(always)]
    pub(crate) fn is_coherent(self, rays: &[Ray], which: &[u32]) -> bool {
        let some = samples(which.len()).map(|i| &rays[which[i] as usize]);
        let turn = spread(some.map(|ray| ray.direction));
        let shift = spread(some.map(|ray| ray.origin));
        turn <= self.turn * size(some[0].direction) && shift <= self.shift
    }
}

/// Asks for the memory of what [`Extent::is_coherent`] looks at; `place` tells where a window's rays lie.
#[inline(always)]
pub(crate) fn ask(rays: &[Ray], place: impl Fn(usize) -> usize) {
    for ray in samples(RAYS).into_iter().filter_map(|i| rays.get(place(i))) {
        prefetch(ray);
    }
}

/// Which rays of a window are looked at.
#[inline(always)]
fn samples(count: usize) -> [usize; 4] {
    let last = count - 1;
    [0, last / 3, last - last / 3, last]
}

/// Whether most of some rays start about as far from the next one as from any other; `ray` tells them by number.
pub(crate) fn are_unordered<'a>(count: usize, ray: impl Fn(usize) -> &'a Ray) -> bool {
    let step = count / SAMPLES;
    if step < 2 {
        return false;
    }
    let pairs: [[Vec3; 2]; SAMPLES] = array::from_fn(|i| [ray(i * step).origin, ray(i * step + 1).origin]);
    let apart = |a: Vec3, b: Vec3| size([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
    let jumps = (0..SAMPLES).filter(|&i| {
        let ([a, next], [any, _]) = (pairs[i], pairs[(i + SAMPLES / 2) % SAMPLES]);
        apart(a, next) > JUMP * apart(a, any)
    });
    4 * jumps.count() >= 3 * SAMPLES
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
