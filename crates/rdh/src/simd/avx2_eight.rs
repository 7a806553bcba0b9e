//! [`Eight`] floats with AVX2 and FMA.
//!
//! "As in `Avx2`": these functions run only within the kernels, where the CPU has the instructions (`avx2.rs`).

use std::arch::x86_64::*;

use super::floats::operations;
use super::{Eight, Floats, Hits};

/// Eight floats in a register.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Wide8(pub(super) __m256);

// SAFETY, for every block below: as in `Avx2`; loads and stores lie within the references they are made from, and are unaligned ones.
impl Eight for Wide8 {
    #[inline(always)]
    fn load(lanes: &[f32; 8]) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_loadu_ps(lanes.as_ptr()) })
    }

    #[inline(always)]
    fn lanes(&self) -> &[f32; 8] {
        // SAFETY: a register in memory is eight floats, aligned to more than they need.
        unsafe { &*std::ptr::from_ref(&self.0).cast() }
    }
}

impl Floats for Wide8 {
    const COUNT: usize = 8;

    type Eight = Self;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        self.lanes()[lane & 7]
    }

    #[inline(always)]
    fn halves(&self) -> [Self; 2] {
        [*self; 2]
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, x: f32) {
        // SAFETY: a register in memory is eight floats, aligned to more than they need; any bits are a value of both.
        let lanes: &mut [f32; 8] = unsafe { &mut *std::ptr::from_mut(&mut self.0).cast() };
        lanes[lane & 7] = x;
    }

    operations! {
        add(other) = _mm256_add_ps;
        sub(other) = _mm256_sub_ps;
        mul(other) = _mm256_mul_ps;
        div(other) = _mm256_div_ps;
        mul_add(factor, term) = _mm256_fmadd_ps;
        min(other) = _mm256_min_ps;
        max(other) = _mm256_max_ps;
        lt(other) = _mm256_cmp_ps::<_CMP_LT_OQ>;
        le(other) = _mm256_cmp_ps::<_CMP_LE_OQ>;
        and(other) = _mm256_and_ps;
        or(other) = _mm256_or_ps;
        xor(other) = _mm256_xor_ps;
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        // SAFETY: see above.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }

    #[inline(always)]
    fn mask(bits: u32) -> Self {
        // SAFETY: see above.
        unsafe {
            let place = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), place);
            Self(_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, place)))
        }
    }

    #[inline(always)]
    fn select(self, yes: Self, no: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, self.0) })
    }

    #[inline(always)]
    fn transposed<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        let rows = [row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)];
        // SAFETY: see above; a row has two halves of four.
        unsafe {
            let (low, high) = (halves(&rows, 0), halves(&rows, 4));
            let ([a, b, c, d], [e, f, g, h]) = (four_columns(low), four_columns(high));
            [Self(a), Self(b), Self(c), Self(d), Self(e), Self(f), Self(g), Self(h)]
        }
    }

    #[inline(always)]
    fn hits(corners: &[[Self; 3]; 3], direction_z: Self, t_min: Self, t_max: Self) -> Hits<Self> {
        let (low, high) = (half(corners, direction_z, false), half(corners, direction_z, true));
        let ([t, u, v], decided) = (joined(&low.numbers, &high.numbers), low.decided | high.decided << 4);
        // SAFETY: see above.
        unsafe {
            // Adding 0 turns -0 into 0. What is no number, or infinite, is no hit.
            let t = _mm256_add_ps(t, _mm256_setzero_ps());
            let from = _mm256_cmp_ps::<_CMP_GE_OQ>(t, _mm256_max_ps(t_min.0, _mm256_set1_ps(f32::MIN)));
            let to = _mm256_cmp_ps::<_CMP_LE_OQ>(t, _mm256_min_ps(t_max.0, _mm256_set1_ps(f32::MAX)));
            let within = _mm256_movemask_ps(_mm256_and_ps(from, to)) as u32;
            Hits { accepted: within & decided, t: Self(t), u: Self(u), v: Self(v) }
        }
    }
}

/// Four floats from a place on, of rows 0 to 3 in the lower halves and of rows 4 to 7 in the upper ones.
///
/// # Safety
/// As in `Avx2`; `from` is at most 4.
#[inline(always)]
unsafe fn halves(rows: &[&[f32; 8]; 8], from: usize) -> [__m256; 4] {
    // SAFETY: see above.
    unsafe {
        let pair = |i: usize| (rows[i].as_ptr().add(from), rows[i + 4].as_ptr().add(from));
        let ((a, e), (b, f), (c, g), (d, h)) = (pair(0), pair(1), pair(2), pair(3));
        [_mm256_loadu2_m128(e, a), _mm256_loadu2_m128(f, b), _mm256_loadu2_m128(g, c), _mm256_loadu2_m128(h, d)]
    }
}

/// Four columns of eight.
#[inline(always)]
fn four_columns([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    // SAFETY: as in `Avx2`.
    unsafe {
        let (low_ab, low_cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
        let (high_ab, high_cd) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0b01_00_01_00>(low_ab, low_cd),
            _mm256_shuffle_ps::<0b11_10_11_10>(low_ab, low_cd),
            _mm256_shuffle_ps::<0b01_00_01_00>(high_ab, high_cd),
            _mm256_shuffle_ps::<0b11_10_11_10>(high_ab, high_cd),
        ]
    }
}

/// What the test finds in four lanes: `t`, `u` and `v`, and in which lanes the signs allow a hit.
struct Half {
    numbers: [__m128; 3],
    decided: u32,
}

/// The operations of `crossing`, in their order, in f64.
#[inline(always)]
fn half(corners: &[[Wide8; 3]; 3], direction_z: Wide8, upper: bool) -> Half {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
    let (ax, ay, az) = (wide(*ax, upper), wide(*ay, upper), wide(*az, upper));
    let (bx, by, bz) = (wide(*bx, upper), wide(*by, upper), wide(*bz, upper));
    let (cx, cy, cz) = (wide(*cx, upper), wide(*cy, upper), wide(*cz, upper));
    let direction_z = wide(direction_z, upper);
    // SAFETY: as in `Avx2`.
    unsafe {
        let zero = _mm256_setzero_pd();
        let a = _mm256_sub_pd(_mm256_mul_pd(cx, by), _mm256_mul_pd(cy, bx));
        let b = _mm256_sub_pd(_mm256_mul_pd(ax, cy), _mm256_mul_pd(ay, cx));
        let c = _mm256_sub_pd(_mm256_mul_pd(bx, ay), _mm256_mul_pd(by, ax));
        let (least, most) = (_mm256_min_pd(_mm256_min_pd(a, b), c), _mm256_max_pd(_mm256_max_pd(a, b), c));
        let both = _mm256_and_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(least, zero), _mm256_cmp_pd::<_CMP_GT_OQ>(most, zero));
        let sum = _mm256_add_pd(_mm256_add_pd(a, b), c);
        let nothing = _mm256_or_pd(both, _mm256_cmp_pd::<_CMP_EQ_OQ>(sum, zero));
        let depth = _mm256_add_pd(_mm256_mul_pd(a, az), _mm256_mul_pd(b, bz));
        let depth = _mm256_add_pd(depth, _mm256_mul_pd(c, cz));
        let t = _mm256_div_pd(depth, _mm256_mul_pd(sum, direction_z));
        let (u, v) = (_mm256_div_pd(b, sum), _mm256_div_pd(c, sum));
        let numbers = [_mm256_cvtpd_ps(t), _mm256_cvtpd_ps(u), _mm256_cvtpd_ps(v)];
        Half { numbers, decided: !(_mm256_movemask_pd(nothing) as u32) & 0xf }
    }
}

#[inline(always)]
fn wide(x: Wide8, upper: bool) -> __m256d {
    // SAFETY: as in `Avx2`.
    unsafe {
        let half = if upper { _mm256_extractf128_ps::<1>(x.0) } else { _mm256_castps256_ps128(x.0) };
        _mm256_cvtps_pd(half)
    }
}

#[inline(always)]
fn joined(low: &[__m128; 3], high: &[__m128; 3]) -> [__m256; 3] {
    // SAFETY: as in `Avx2`.
    unsafe { [_mm256_set_m128(high[0], low[0]), _mm256_set_m128(high[1], low[1]), _mm256_set_m128(high[2], low[2])] }
}
