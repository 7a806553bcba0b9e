//! Which of a batch's rays make a tile.

use super::RAYS;
use crate::geom::{PlaneFrame, Ray, RayFrame};

/// At most 64 of a batch's rays, by their numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Choice {
    rays: [u32; RAYS],
    count: usize,
}

impl Choice {
    /// None.
    const NONE: Self = Self { rays: [0; RAYS], count: 0 };

    /// Rays that follow each other, up to 64.
    #[inline(always)]
    pub(crate) fn run(from: usize, count: usize) -> Self {
        let mut choice = Self::NONE;
        for (i, ray) in choice.rays[..count.min(RAYS)].iter_mut().enumerate() {
            *ray = (from + i) as u32;
        }
        choice.count = count.min(RAYS);
        choice
    }

    /// Eight rows of up to eight rays, in Morton order, so that packets are compact.
    #[inline(always)]
    pub(crate) fn square(from: usize, width: usize, columns: usize) -> Self {
        let mut choice = Self::NONE;
        for i in 0..RAYS {
            let (x, y) = place(i);
            choice.rays[choice.count] = (from + y * width + x) as u32;
            choice.count += usize::from(x < columns);
        }
        choice
    }

    /// Their numbers.
    #[inline(always)]
    pub(crate) fn rays(&self) -> &[u32] {
        &self.rays[..self.count.min(RAYS)]
    }

    /// Those that are of the first one's class, and the others.
    pub(crate) fn first_class(&self, rays: &[Ray]) -> (Self, Self) {
        let first = self.rays().first().map(|&ray| class(&rays[ray as usize]));
        let (mut same, mut others) = (Self::NONE, Self::NONE);
        for &ray in self.rays() {
            let choice = if Some(class(&rays[ray as usize])) == first { &mut same } else { &mut others };
            choice.rays[choice.count] = ray;
            choice.count += 1;
        }
        (same, others)
    }
}

/// Column and row of ray `i` of a square, in Morton order.
#[inline(always)]
pub(super) fn place(i: usize) -> (usize, usize) {
    (i & 1 | i >> 1 & 2 | i >> 2 & 4, i >> 1 & 1 | i >> 2 & 2 | i >> 3 & 4)
}

/// A ray's octant and longest axis, and whether it needs no care.
fn class(ray: &Ray) -> (u32, usize, bool) {
    let sign = |x: f32| x.to_bits() >> 31;
    let [x, y, z] = ray.direction;
    (sign(x) | sign(y) << 1 | sign(z) << 2, RayFrame::main_axis(&ray.direction), PlaneFrame::is_usual(ray))
}
