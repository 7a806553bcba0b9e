//! Sixteen [`Floats`] with AVX-512.
//!
//! "As in `Avx512`": these functions run only within the kernels, where the CPU has the instructions (`avx512.rs`).

use std::arch::x86_64::*;

use super::avx2_eight::Wide8;
use super::floats::operations;
use super::{Floats, Hits};

/// Sixteen floats in a register.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Wide16(__m512);

// SAFETY, for every block below: as in `Avx512`.
impl Floats for Wide16 {
    const COUNT: usize = 16;

    type Eight = Wide8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_set1_ps(x) })
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        // SAFETY: a register in memory is sixteen floats, aligned to more than they need.
        let lanes: &[f32; 16] = unsafe { &*std::ptr::from_ref(&self.0).cast() };
        lanes[lane & 15]
    }

    #[inline(always)]
    fn halves(&self) -> [Wide8; 2] {
        // SAFETY: see above.
        unsafe { [Wide8(_mm512_castps512_ps256(self.0)), Wide8(_mm512_extractf32x8_ps::<1>(self.0))] }
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, x: f32) {
        // SAFETY: a register in memory is sixteen floats, aligned to more than they need; any bits are a value of both.
        let lanes: &mut [f32; 16] = unsafe { &mut *std::ptr::from_mut(&mut self.0).cast() };
        lanes[lane & 15] = x;
    }

    operations! {
        add(other) = _mm512_add_ps;
        sub(other) = _mm512_sub_ps;
        mul(other) = _mm512_mul_ps;
        div(other) = _mm512_div_ps;
        mul_add(factor, term) = _mm512_fmadd_ps;
        min(other) = _mm512_min_ps;
        max(other) = _mm512_max_ps;
        and(other) = _mm512_and_ps;
        or(other) = _mm512_or_ps;
        xor(other) = _mm512_xor_ps;
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        // SAFETY: see above.
        Self::mask(u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self {
        // SAFETY: see above.
        Self::mask(u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) }))
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        u32::from(signs(self))
    }

    #[inline(always)]
    fn mask(bits: u32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_castsi512_ps(_mm512_movm_epi32(bits as __mmask16)) })
    }

    #[inline(always)]
    fn select(self, yes: Self, no: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_mask_blend_ps(signs(self), no.0, yes.0) })
    }

    #[inline(always)]
    fn transposed<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        let (low, high) = (Wide8::transposed(&row), Wide8::transposed(|i| row(i + 8)));
        let ([a, b, c, d, e, f, g, h], [i, j, k, l, m, n, o, p]) = (low, high);
        [joined(a, i), joined(b, j), joined(c, k), joined(d, l), joined(e, m), joined(f, n), joined(g, o), joined(h, p)]
    }

    #[inline(always)]
    fn hits(corners: &[[Self; 3]; 3], direction_z: Self, t_min: Self, t_max: Self) -> Hits<Self> {
        let (low, high) = (half(corners, direction_z, false), half(corners, direction_z, true));
        let (t, u, v) = (joined(low.t, high.t), joined(low.u, high.u), joined(low.v, high.v));
        // SAFETY: see above.
        unsafe {
            // Adding 0 turns -0 into 0. What is no number, or infinite, is no hit.
            let t = _mm512_add_ps(t.0, _mm512_setzero_ps());
            let from = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(t, _mm512_max_ps(t_min.0, _mm512_set1_ps(f32::MIN)));
            let to = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(t, _mm512_min_ps(t_max.0, _mm512_set1_ps(f32::MAX)));
            let decided = u32::from(low.decided) | u32::from(high.decided) << 8;
            Hits { accepted: u32::from(from & to) & decided, t: Self(t), u, v }
        }
    }
}

#[inline(always)]
fn signs(x: Wide16) -> __mmask16 {
    // SAFETY: as in `Avx512`.
    unsafe { _mm512_movepi32_mask(_mm512_castps_si512(x.0)) }
}

#[inline(always)]
fn joined(low: Wide8, high: Wide8) -> Wide16 {
    // SAFETY: as in `Avx512`.
    Wide16(unsafe { _mm512_insertf32x8::<1>(_mm512_castps256_ps512(low.0), high.0) })
}

/// What the test finds in eight lanes, and in which of them the signs allow a hit.
struct Half {
    t: Wide8,
    u: Wide8,
    v: Wide8,
    decided: __mmask8,
}

/// The operations of `crossing`, in their order, in f64.
#[inline(always)]
fn half(corners: &[[Wide16; 3]; 3], direction_z: Wide16, upper: bool) -> Half {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
    let (ax, ay, az) = (wide(*ax, upper), wide(*ay, upper), wide(*az, upper));
    let (bx, by, bz) = (wide(*bx, upper), wide(*by, upper), wide(*bz, upper));
    let (cx, cy, cz) = (wide(*cx, upper), wide(*cy, upper), wide(*cz, upper));
    let direction_z = wide(direction_z, upper);
    // SAFETY: as in `Avx512`.
    unsafe {
        let zero = _mm512_setzero_pd();
        let a = _mm512_sub_pd(_mm512_mul_pd(cx, by), _mm512_mul_pd(cy, bx));
        let b = _mm512_sub_pd(_mm512_mul_pd(ax, cy), _mm512_mul_pd(ay, cx));
        let c = _mm512_sub_pd(_mm512_mul_pd(bx, ay), _mm512_mul_pd(by, ax));
        let (least, most) = (_mm512_min_pd(_mm512_min_pd(a, b), c), _mm512_max_pd(_mm512_max_pd(a, b), c));
        let both = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(least, zero) & _mm512_cmp_pd_mask::<_CMP_GT_OQ>(most, zero);
        let sum = _mm512_add_pd(_mm512_add_pd(a, b), c);
        let nothing = both | _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(sum, zero);
        let depth = _mm512_add_pd(_mm512_mul_pd(a, az), _mm512_mul_pd(b, bz));
        let depth = _mm512_add_pd(depth, _mm512_mul_pd(c, cz));
        let t = _mm512_div_pd(depth, _mm512_mul_pd(sum, direction_z));
        let (u, v) = (_mm512_div_pd(b, sum), _mm512_div_pd(c, sum));
        let (t, u, v) = (_mm512_cvtpd_ps(t), _mm512_cvtpd_ps(u), _mm512_cvtpd_ps(v));
        Half { t: Wide8(t), u: Wide8(u), v: Wide8(v), decided: !nothing }
    }
}

#[inline(always)]
fn wide(x: Wide16, upper: bool) -> __m512d {
    // SAFETY: as in `Avx512`.
    unsafe {
        let half = if upper { _mm512_extractf32x8_ps::<1>(x.0) } else { _mm512_castps512_ps256(x.0) };
        _mm512_cvtps_pd(half)
    }
}
