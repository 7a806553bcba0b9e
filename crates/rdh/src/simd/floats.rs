//! Floats side by side: what packets of rays are computed with, written once for all levels.
//!
//! No implementation calls intrinsics in closures: those lose the instruction set, and each intrinsic becomes a call.

use super::Eight;
use crate::geom::{larger, smaller};

/// Eight or sixteen floats. Comparisons give lanes of all ones or all zeros; nothing that has to be the same everywhere is fused.
pub(crate) trait Floats: Copy {
    /// How many.
    const COUNT: usize;

    /// Eight of them: what blocks of triangles and nodes have lanes for.
    type Eight: Eight;

    /// The same number in all lanes.
    fn splat(x: f32) -> Self;

    /// The number in a lane; of lanes beyond the last one, as if they were counted on from the first.
    fn lane(&self, lane: usize) -> f32;

    /// The lower and the upper half of sixteen; of eight, twice all.
    fn halves(&self) -> [Self::Eight; 2];

    /// Puts a number into a lane.
    fn set_lane(&mut self, lane: usize, x: f32);

    /// The sum.
    fn add(self, other: Self) -> Self;

    /// The difference.
    fn sub(self, other: Self) -> Self;

    /// The product.
    fn mul(self, other: Self) -> Self;

    /// The quotient.
    fn div(self, other: Self) -> Self;

    /// `self · factor + term`, rounded once or twice: for boxes alone.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// The smaller one; the other's lane where one is no number.
    fn min(self, other: Self) -> Self;

    /// The larger one; the other's lane where one is no number.
    fn max(self, other: Self) -> Self;

    /// Whether it is less; not where one is no number.
    fn lt(self, other: Self) -> Self;

    /// Whether it is less or equal; not where one is no number.
    fn le(self, other: Self) -> Self;

    /// Bit by bit.
    fn and(self, other: Self) -> Self;

    /// Bit by bit.
    fn or(self, other: Self) -> Self;

    /// Bit by bit.
    fn xor(self, other: Self) -> Self;

    /// The sign bits: a bit a lane.
    fn signs(self) -> u32;

    /// All ones in the lanes whose bits are set.
    fn mask(bits: u32) -> Self;

    /// The lanes of `yes` where the sign bit of `self` is set, else those of `no`.
    fn select(self, yes: Self, no: Self) -> Self;

    /// Rows as columns; each lane has its row.
    fn transposed<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8];

    /// THE triangle test from the corners in the rays' frames on, bit for bit as in `crossing`.
    fn hits(corners: &[[Self; 3]; 3], direction_z: Self, t_min: Self, t_max: Self) -> Hits<Self>;
}

/// Where triangles are hit: meaningless in lanes that are not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hits<F> {
    /// A bit a lane.
    pub(crate) accepted: u32,
    pub(crate) t: F,
    pub(crate) u: F,
    pub(crate) v: F,
}

/// Operations that are one instruction each, of a register in a struct.
#[cfg(target_arch = "x86_64")]
macro_rules! operations {
    ($($name:ident($($other:ident),*) = $intrinsic:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($other: Self),*) -> Self {
                // SAFETY: as in the kernels, which alone name these types: the CPU has the instructions.
                Self(unsafe { $intrinsic(self.0, $($other.0),*) })
            }
        )*
    };
}

#[cfg(target_arch = "x86_64")]
pub(super) use operations;

/// All lanes, a bit each.
#[inline(always)]
pub(crate) fn all_lanes<F: Floats>() -> u32 {
    (1 << F::COUNT) - 1
}

/// The smallest lane. What is no number is left out.
#[inline(always)]
pub(crate) fn lowest<F: Floats>(x: &F) -> f32 {
    let mut lowest = f32::INFINITY;
    for i in 0..F::COUNT {
        lowest = smaller(x.lane(i), lowest);
    }
    lowest
}

/// The largest lane. What is no number is left out.
#[inline(always)]
pub(crate) fn highest<F: Floats>(x: &F) -> f32 {
    let mut highest = f32::NEG_INFINITY;
    for i in 0..F::COUNT {
        highest = larger(x.lane(i), highest);
    }
    highest
}

/// Of each of eight, its smallest and its largest lane. No lane may be no number.
#[inline(always)]
pub(crate) fn extremes<F: Floats>([a, b, c, d, e, f, g, h]: [&F; 8]) -> [F::Eight; 2] {
    let halves = [a.halves(), b.halves(), c.halves(), d.halves(), e.halves(), f.halves(), g.halves(), h.halves()];
    let (mut low, mut high) = (F::Eight::splat(f32::INFINITY), F::Eight::splat(f32::NEG_INFINITY));
    for half in 0..F::COUNT / 8 {
        for column in F::Eight::transposed(|i| halves[i & 7][half & 1].lanes()) {
            low = low.min(column);
            high = high.max(column);
        }
    }
    [low, high]
}

/// Without the sign.
#[inline(always)]
pub(crate) fn size<F: Floats>(x: F) -> F {
    let sign = F::splat(-0.0);
    x.or(sign).xor(sign)
}

/// A point, along the frames' axes, in rays' frames: never fused, as in THE triangle test.
#[inline(always)]
pub(crate) fn sheared<F: Floats>(&[x, y, z]: &[F; 3], origin: &[F; 3], shear: &[F; 2]) -> [F; 3] {
    let z = z.sub(origin[2]);
    [x.sub(origin[0]).sub(shear[0].mul(z)), y.sub(origin[1]).sub(shear[1].mul(z)), z]
}
