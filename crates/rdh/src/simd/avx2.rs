//! x86-64 with AVX2: eight lanes at once.

use std::arch::x86_64::*;

use super::{Block, Job, Kernels};
use crate::geom::RayFrame;

/// Runs a job with AVX2.
///
/// # Safety
/// The CPU must have AVX2, BMI1 and BMI2.
#[target_feature(enable = "avx2,bmi1,bmi2")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Avx2>()
}

/// AVX2; used only inside [`enter`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2;

/// A frame in registers.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    k: [usize; 3],
    origin: [__m256; 3],
    shear: [__m256; 2],
}

// SAFETY, for every block below: `Avx2` is named only in `enter`, whose caller has made sure of AVX2; loads and stores
// are unaligned ones, within the references they are made from.
impl Kernels for Avx2 {
    type Frame = Frame;

    #[inline(always)]
    fn frame(frame: &RayFrame) -> Frame {
        // SAFETY: see above.
        let spread = |x: f32| unsafe { _mm256_set1_ps(x) };
        Frame { k: frame.k, origin: frame.k.map(|k| spread(frame.origin[k])), shear: frame.shear.map(spread) }
    }

    #[inline(always)]
    fn candidates(frame: &Frame, block: &Block) -> u32 {
        let [kx, ky, kz] = frame.k;
        // SAFETY: see above; every row of a block is eight floats.
        unsafe {
            let load = |c: usize, a: usize| _mm256_loadu_ps(block.corners[c][a].as_ptr());
            let point = |c: usize| {
                let z = _mm256_sub_ps(load(c, kz), frame.origin[2]);
                let x = _mm256_sub_ps(_mm256_sub_ps(load(c, kx), frame.origin[0]), _mm256_mul_ps(frame.shear[0], z));
                let y = _mm256_sub_ps(_mm256_sub_ps(load(c, ky), frame.origin[1]), _mm256_mul_ps(frame.shear[1], z));
                (x, y)
            };
            let (p0, p1, p2) = (point(0), point(1), point(2));
            let cross = |a: (__m256, __m256), b: (__m256, __m256)| {
                _mm256_sub_ps(_mm256_mul_ps(a.0, b.1), _mm256_mul_ps(a.1, b.0))
            };
            let (u, v, w) = (cross(p2, p1), cross(p0, p2), cross(p1, p0));
            let zero = _mm256_setzero_ps();
            let below = |x: __m256| _mm256_cmp_ps::<_CMP_LT_OQ>(x, zero);
            let above = |x: __m256| _mm256_cmp_ps::<_CMP_GT_OQ>(x, zero);
            let negative = _mm256_or_ps(_mm256_or_ps(below(u), below(v)), below(w));
            let positive = _mm256_or_ps(_mm256_or_ps(above(u), above(v)), above(w));
            !(_mm256_movemask_ps(_mm256_and_ps(negative, positive)) as u32) & 0xff
        }
    }

    #[inline(always)]
    fn count_below(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        count::<_CMP_LT_OQ>(values, planes, counts);
    }

    #[inline(always)]
    fn count_up_to(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        count::<_CMP_LE_OQ>(values, planes, counts);
    }

    #[inline(always)]
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8] {
        let mut out = [0; 8];
        // SAFETY: see above; all arrays have eight elements.
        unsafe {
            let load = |x: &[f32; 8]| _mm256_loadu_ps(x.as_ptr());
            let bins = _mm256_mul_ps(_mm256_sub_ps(load(values), load(first)), load(scale));
            let bins = _mm256_cvttps_epi32(bins);
            let bins = _mm256_min_epi32(_mm256_max_epi32(bins, _mm256_setzero_si256()), _mm256_set1_epi32(last));
            _mm256_storeu_si256(out.as_mut_ptr().cast(), bins);
        }
        out
    }
}

#[inline(always)]
fn count<const COMPARISON: i32>(values: &[f32], planes: &[f32], counts: &mut [u32]) {
    for (planes, counts) in planes.chunks_exact(8).zip(counts.chunks_exact_mut(8)) {
        // SAFETY: as in `Avx2`; both chunks have eight elements.
        unsafe {
            let planes = _mm256_loadu_ps(planes.as_ptr());
            let mut sum = _mm256_setzero_si256();
            for &value in values {
                let counted = _mm256_cmp_ps::<COMPARISON>(_mm256_set1_ps(value), planes);
                sum = _mm256_sub_epi32(sum, _mm256_castps_si256(counted));
            }
            _mm256_storeu_si256(counts.as_mut_ptr().cast(), sum);
        }
    }
}
