//! Four floats: what cutting triangles computes with. x86-64 always has SSE2 and ARM's compilers see through the arrays, so that
//! no level is asked for; each operation is the IEEE one, lane by lane, and gives the same bits everywhere.

use std::ops::{Add, Mul, Sub};

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// Four floats, of which cutting uses three.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Four(#[cfg(target_arch = "x86_64")] __m128, #[cfg(not(target_arch = "x86_64"))] [f32; 4]);

// SAFETY, for every block below: all x86-64 CPUs have SSE2, and arrays of four floats are loaded and stored unaligned.
#[cfg(target_arch = "x86_64")]
impl Four {
    /// From an array.
    #[inline(always)]
    pub(crate) fn new(lanes: [f32; 4]) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm_loadu_ps(lanes.as_ptr()) })
    }

    /// As an array.
    #[inline(always)]
    pub(crate) fn lanes(self) -> [f32; 4] {
        let mut lanes = [0.0; 4];
        // SAFETY: see above.
        unsafe { _mm_storeu_ps(lanes.as_mut_ptr(), self.0) };
        lanes
    }

    /// The smaller one of each lane; the other's where one is no number.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm_min_ps(self.0, other.0) })
    }

    /// The larger one of each lane; the other's where one is no number.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm_max_ps(self.0, other.0) })
    }

    /// Without signs.
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), self.0) })
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Four {
    /// From an array.
    #[inline(always)]
    pub(crate) fn new(lanes: [f32; 4]) -> Self {
        Self(lanes)
    }

    /// As an array.
    #[inline(always)]
    pub(crate) fn lanes(self) -> [f32; 4] {
        self.0
    }

    /// The smaller one of each lane; the other's where one is no number.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    /// The larger one of each lane; the other's where one is no number.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    /// Without signs.
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl Four {
    /// Larger than all numbers.
    pub(crate) const INFINITY: Self = Self::of([f32::INFINITY; 4]);
    /// Smaller than all numbers.
    pub(crate) const NEG_INFINITY: Self = Self::of([f32::NEG_INFINITY; 4]);

    /// A constant.
    const fn of(lanes: [f32; 4]) -> Self {
        // SAFETY: both are four floats, whatever they are.
        #[cfg(target_arch = "x86_64")]
        return Self(unsafe { std::mem::transmute::<[f32; 4], __m128>(lanes) });
        #[cfg(not(target_arch = "x86_64"))]
        Self(lanes)
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(x: f32) -> Self {
        Self::new([x; 4])
    }

    /// A point; the last lane is 0.
    #[inline(always)]
    pub(crate) fn point([x, y, z]: [f32; 3]) -> Self {
        Self::new([x, y, z, 0.0])
    }

    /// The first three lanes.
    #[inline(always)]
    pub(crate) fn to_point(self) -> [f32; 3] {
        let [x, y, z, _] = self.lanes();
        [x, y, z]
    }
}

/// An operator, lane by lane.
macro_rules! lane_by_lane {
    ($operator:ident, $name:ident, $intrinsic:ident, $sign:tt) => {
        impl $operator for Four {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as in `Four`.
                return Self(unsafe { $intrinsic(self.0, other.0) });
                #[cfg(not(target_arch = "x86_64"))]
                self.each(other, |a, b| a $sign b)
            }
        }
    };
}

lane_by_lane!(Add, add, _mm_add_ps, +);
lane_by_lane!(Sub, sub, _mm_sub_ps, -);
lane_by_lane!(Mul, mul, _mm_mul_ps, *);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_computed_as_numbers_are() {
        let numbers = [0.0, -0.0, 1.5, -2.25, 1e-40, -3e38, f32::INFINITY];
        for a in numbers {
            for b in numbers {
                let (x, y) = (Four::new([a, b, 1.0, a]), Four::new([b, a, -1.0, a]));
                let bits = |four: Four| four.lanes().map(f32::to_bits);
                assert_eq!(bits(x.min(y))[0], if a < b { a } else { b }.to_bits(), "{a} {b}");
                assert_eq!(bits(x.max(y))[0], if a > b { a } else { b }.to_bits(), "{a} {b}");
                assert_eq!(bits(x.abs()), [a.abs(), b.abs(), 1.0, a.abs()].map(f32::to_bits));
                assert_eq!((x - y).lanes()[2], 2.0);
                assert!((x + y).lanes()[1] == a + b || (a + b).is_nan());
                assert!((x * y).lanes()[0] == a * b || (a * b).is_nan());
            }
        }
        assert_eq!(Four::point([1.0, 2.0, 3.0]).to_point(), [1.0, 2.0, 3.0]);
    }
}
