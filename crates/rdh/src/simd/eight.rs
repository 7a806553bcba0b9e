//! Eight floats at once: as many as there are lanes in blocks and nodes.

use super::{Floats, Hits};
use crate::geom::crossing;

/// Eight floats, to and from memory.
pub(crate) trait Eight: Floats<Eight = Self> {
    /// From an array.
    fn load(lanes: &[f32; 8]) -> Self;

    /// The lanes, in memory.
    fn lanes(&self) -> &[f32; 8];
}

/// Plain floats.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Plain8([f32; 8]);

impl Plain8 {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compared(self, other: Self, f: impl Fn(f32, f32) -> bool) -> Self {
        self.each(other, |a, b| f32::from_bits(if f(a, b) { u32::MAX } else { 0 }))
    }

    #[inline(always)]
    fn bitwise(self, other: Self, f: impl Fn(u32, u32) -> u32) -> Self {
        self.each(other, |a, b| f32::from_bits(f(a.to_bits(), b.to_bits())))
    }
}

impl Eight for Plain8 {
    #[inline(always)]
    fn load(lanes: &[f32; 8]) -> Self {
        Self(*lanes)
    }

    #[inline(always)]
    fn lanes(&self) -> &[f32; 8] {
        &self.0
    }
}

impl Floats for Plain8 {
    const COUNT: usize = 8;

    type Eight = Self;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        self.0[lane & 7]
    }

    #[inline(always)]
    fn halves(&self) -> [Self; 2] {
        [*self; 2]
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, x: f32) {
        self.0[lane & 7] = x;
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.each(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.each(other, |a, b| a / b)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.mul(factor).add(term)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        self.compared(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self {
        self.compared(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self.bitwise(other, |a, b| a & b)
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self.bitwise(other, |a, b| a | b)
    }

    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        self.bitwise(other, |a, b| a ^ b)
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        (0..8).fold(0, |bits, i| bits | (self.0[i].to_bits() >> 31) << i)
    }

    #[inline(always)]
    fn mask(bits: u32) -> Self {
        let mut lanes = [0.0; 8];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f32::from_bits(0u32.wrapping_sub(bits >> i & 1));
        }
        Self(lanes)
    }

    #[inline(always)]
    fn select(self, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i].to_bits() >> 31 == 1 { yes.0[i] } else { no.0[i] }))
    }

    #[inline(always)]
    fn transposed<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        let mut columns = [Self([0.0; 8]); 8];
        for i in 0..8 {
            for (column, &x) in columns.iter_mut().zip(row(i)) {
                column.0[i] = x;
            }
        }
        columns
    }

    #[inline(always)]
    fn hits(corners: &[[Self; 3]; 3], direction_z: Self, t_min: Self, t_max: Self) -> Hits<Self> {
        let nothing = Self([0.0; 8]);
        let mut hits = Hits { accepted: 0, t: nothing, u: nothing, v: nothing };
        for i in 0..8 {
            let corner = |c: usize| [corners[c][0].0[i], corners[c][1].0[i], corners[c][2].0[i]];
            let p = [corner(0), corner(1), corner(2)];
            if let Some([t, u, v]) = crossing(&p, direction_z.0[i], (t_min.0[i], t_max.0[i])) {
                hits.accepted |= 1 << i;
                (hits.t.0[i], hits.u.0[i], hits.v.0[i]) = (t, u, v);
            }
        }
        hits
    }
}
