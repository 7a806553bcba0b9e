//! Eight floats at once: what packets of rays are computed with, written once for all levels.

use crate::geom::crossing;

/// Eight floats. Comparisons give lanes of all ones or all zeros; nothing that has to be the same everywhere is fused.
pub(crate) trait Eight: Copy {
    /// The same number in all lanes.
    fn splat(x: f32) -> Self;

    /// From an array.
    fn load(lanes: &[f32; 8]) -> Self;

    /// The lanes, in memory.
    fn lanes(&self) -> &[f32; 8];

    /// The lanes, in memory.
    fn lanes_mut(&mut self) -> &mut [f32; 8];

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

    /// Rows as columns.
    fn transposed(rows: [&[f32; 8]; 8]) -> [Self; 8];

    /// THE triangle test from the corners in the rays' frames on, bit for bit as in `crossing`.
    fn hits(corners: &[[Self; 3]; 3], direction_z: Self, t_min: Self, t_max: Self) -> Hits<Self>;
}

/// Where eight triangles are hit: meaningless in lanes that are not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hits<E> {
    /// A bit a lane.
    pub(crate) accepted: u32,
    pub(crate) t: E,
    pub(crate) u: E,
    pub(crate) v: E,
}

/// Without the sign.
#[inline(always)]
pub(crate) fn size<E: Eight>(x: E) -> E {
    let sign = E::splat(-0.0);
    x.or(sign).xor(sign)
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
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }

    #[inline(always)]
    fn load(lanes: &[f32; 8]) -> Self {
        Self(*lanes)
    }

    #[inline(always)]
    fn lanes(&self) -> &[f32; 8] {
        &self.0
    }

    #[inline(always)]
    fn lanes_mut(&mut self) -> &mut [f32; 8] {
        &mut self.0
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
    fn transposed(rows: [&[f32; 8]; 8]) -> [Self; 8] {
        let mut columns = [Self([0.0; 8]); 8];
        for (i, row) in rows.iter().enumerate() {
            for (column, &x) in columns.iter_mut().zip(*row) {
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
