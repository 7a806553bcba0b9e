//! x86-64 with AVX-512: the lanes of AVX2, compared into mask registers.

use std::arch::x86_64::*;

use super::avx2::{
    Avx2, Frame, WideRay, cross, enter_and_leave, enter_and_leave_few, shear, store_few,
};
use super::{Block, Boxes, Entered, Job, Kernels, Sifted};
use crate::geom::{Ray, RayFrame, Scale};

/// Runs a job with AVX-512.
///
/// # Safety
/// The CPU must have AVX2, FMA, BMI1, BMI2, and AVX-512 F, VL, DQ and BW.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,avx512f,avx512vl,avx512dq,avx512bw")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Avx512>()
}

/// AVX-512; used only inside [`enter`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx512;

// SAFETY, for every block below: `Avx512` is named only in `enter`, whose caller has made sure of the instructions; loads and
// stores lie within the references they are made from.
impl Kernels for Avx512 {
    type Frame = Frame;
    type BoxRay = WideRay;

    #[inline(always)]
    fn frames(ray: &Ray) -> (RayFrame, Frame) {
        Avx2::frames(ray)
    }

    #[inline(always)]
    fn shorten(lanes: &mut Frame, frame: &RayFrame) {
        Avx2::shorten(lanes, frame);
    }

    #[inline(always)]
    fn sift(frame: &Frame, block: &Block) -> Sifted {
        let (p0, p1, p2) =
            (shear(frame, &block.corners[0]), shear(frame, &block.corners[1]), shear(frame, &block.corners[2]));
        let (u, v, w) = (cross(p2, p1), cross(p0, p2), cross(p1, p0));
        // SAFETY: see above.
        unsafe {
            let zero = _mm256_setzero_ps();
            let below = _mm256_cmp_ps_mask::<_CMP_LT_OQ>(u, zero)
                | _mm256_cmp_ps_mask::<_CMP_LT_OQ>(v, zero)
                | _mm256_cmp_ps_mask::<_CMP_LT_OQ>(w, zero);
            let above = _mm256_cmp_ps_mask::<_CMP_GT_OQ>(u, zero)
                | _mm256_cmp_ps_mask::<_CMP_GT_OQ>(v, zero)
                | _mm256_cmp_ps_mask::<_CMP_GT_OQ>(w, zero);
            // A hit's depth lies between those of the corners.
            let first = _mm256_min_ps(_mm256_min_ps(p0.2, p1.2), p2.2);
            let last = _mm256_max_ps(_mm256_max_ps(p0.2, p1.2), p2.2);
            let beyond = _mm256_cmp_ps_mask::<_CMP_LT_OQ>(last, frame.limits.nearest)
                | _mm256_cmp_ps_mask::<_CMP_GT_OQ>(first, frame.limits.farthest);
            let possible = !((below & above) | beyond);
            // Strictly inside: of one sign, and none of them 0 or NaN.
            let signs = _mm256_cmp_ps_mask::<_CMP_NEQ_OQ>(u, zero)
                & _mm256_cmp_ps_mask::<_CMP_NEQ_OQ>(v, zero)
                & _mm256_cmp_ps_mask::<_CMP_NEQ_OQ>(w, zero);
            let within = _mm256_cmp_ps_mask::<_CMP_GT_OQ>(first, frame.limits.surely_from)
                & _mm256_cmp_ps_mask::<_CMP_LT_OQ>(last, frame.limits.surely_to);
            Sifted { possible: u32::from(possible), certain: u32::from(signs & !(below & above) & within) }
        }
    }

    #[inline(always)]
    fn box_ray(ray: &Ray, scale: Scale, magnitude: f32) -> Option<WideRay> {
        Avx2::box_ray(ray, scale, magnitude)
    }

    #[inline(always)]
    fn end(ray: &WideRay) -> f32 {
        Avx2::end(ray)
    }

    #[inline(always)]
    fn end_at(ray: &mut WideRay, t: f32) {
        Avx2::end_at(ray, t);
    }

    #[inline(always)]
    fn meet<const W: usize>(ray: &WideRay, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32 {
        // SAFETY: see above; `t` is aligned to 32 bytes, which has as many lanes as are stored.
        unsafe {
            if W == 8 {
                let (near, far) = enter_and_leave(ray, boxes);
                _mm256_store_ps(t.0.as_mut_ptr(), near);
                u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(near, far))
            } else {
                let (near, far) = enter_and_leave_few(ray, boxes);
                store_few(t, near);
                u32::from(_mm_cmp_ps_mask::<_CMP_LE_OQ>(near, far)) & ((1 << W) - 1)
            }
        }
    }

    #[inline(always)]
    fn count_below(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        Avx2::count_below(values, planes, counts);
    }

    #[inline(always)]
    fn count_up_to(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        Avx2::count_up_to(values, planes, counts);
    }

    #[inline(always)]
    fn weigh<const FROM: bool>(values: &[f32], weights: &[f32], planes: &[f32], sums: &mut [f32]) {
        Avx2::weigh::<FROM>(values, weights, planes, sums);
    }

    #[inline(always)]
    fn lower(mine: &mut [f32; 8], theirs: &[f32; 8]) {
        Avx2::lower(mine, theirs);
    }

    #[inline(always)]
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8] {
        Avx2::bin(values, first, scale, last)
    }
}
