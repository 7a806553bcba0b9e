//! x86-64 with AVX-512: the lanes of AVX2, compared into mask registers.

use std::arch::x86_64::*;

use super::avx2::{Avx2, Frame, Spans, spans};
use super::avx2_boxes::{WideRay, enter_and_leave, enter_and_leave_few, store_few};
use super::avx2_sight;
use super::{
    Aims, Block, Boxes, Corners, Entered, Entry, Indices, Job, Kernels, Met, Octet, RAYS, Shade, Sifted, Sight, Views,
};
use crate::geom::{Ray, RayFrame, Scale, Vec3};

/// Runs a job with AVX-512.
///
/// # Safety
/// The CPU must have AVX2, FMA, BMI1, BMI2, and AVX-512 F, VL, DQ and BW.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,avx512f,avx512vl,avx512dq,avx512bw")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Avx512>()
}

/// AVX-512. Named only in [`enter`]: the kernels run nowhere else.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx512;

// SAFETY, for every block below: `Avx512` is named only in `enter`, whose caller has made sure of the instructions; loads and
// stores lie within the references they are made from, and are unaligned ones but where the block says otherwise.
impl Kernels for Avx512 {
    #[cfg(feature = "twin")]
    const MASKS: bool = true;

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
    fn sift<const CERTAIN: bool>(frame: &Frame, block: &Block, wanted: u32) -> Sifted {
        let spans = spans(frame, block);
        let Spans { least, most, first, last, .. } = spans;
        // SAFETY: see above.
        unsafe {
            let zero = _mm256_setzero_ps();
            let wanted = wanted as __mmask8;
            // A hit's depth lies between those of the corners. What is not a number says nothing.
            let within = _mm256_mask_cmp_ps_mask::<_CMP_NLT_UQ>(wanted, last, frame.limits.nearest);
            let within = _mm256_mask_cmp_ps_mask::<_CMP_NGT_UQ>(within, first, frame.limits.farthest);
            let mut possible = _mm256_mask_cmp_ps_mask::<_CMP_NLT_UQ>(within, least, zero)
                | _mm256_mask_cmp_ps_mask::<_CMP_NGT_UQ>(within, most, zero);
            // Any-hit rays mostly come from a surface: to ask whether it matters would cost them more.
            let start = frame.limits.start;
            let both_sides = _mm256_mask_cmp_ps_mask::<_CMP_LT_OQ>(wanted, first, start);
            if CERTAIN || _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(both_sides, last, start) != 0 {
                possible &= _mm256_cmp_ps_mask::<_CMP_NLT_UQ>(spans.before_start(frame), zero);
            }
            if !CERTAIN {
                return Sifted { possible: u32::from(possible), certain: 0 };
            }
            let within = _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(wanted, first, frame.limits.surely_from);
            let within = _mm256_mask_cmp_ps_mask::<_CMP_LT_OQ>(within, last, frame.limits.surely_to);
            let sum = spans.sum();
            let within = _mm256_mask_cmp_ps_mask::<_CMP_ORD_Q>(within, sum, sum);
            let certain = _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(within, least, zero)
                | _mm256_mask_cmp_ps_mask::<_CMP_LT_OQ>(within, most, zero);
            Sifted { possible: u32::from(possible), certain: u32::from(certain) }
        }
    }

    #[inline(always)]
    fn corners(ray: &RayFrame, frame: &Frame, block: &Block, lane: usize) -> [Vec3; 3] {
        Avx2::corners(ray, frame, block, lane)
    }

    #[inline(always)]
    fn gather(points: &[Vec3], indices: &Indices, block: &mut Block) {
        Avx2::gather(points, indices, block);
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
        const { assert!(W == 2 || W == 4 || W == 8, "no such boxes") }
        // SAFETY: see above; `W` is 2, 4 or 8. Eight lanes are stored aligned: `t` has as many, and is aligned to 32 bytes.
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

    #[inline(always)]
    fn in_view(entry: &Entry, views: &Views) -> u32 {
        avx2_sight::in_view(entry, views)
    }

    #[inline(always)]
    fn see(sight: &Sight, index: u32, octet: &mut Octet) -> bool {
        avx2_sight::see(sight, index, octet)
    }

    #[inline(always)]
    fn shade(sight: &Sight, rays: &Shade) -> Sifted {
        avx2_sight::shade(sight, rays)
    }

    #[inline(always)]
    fn aim(rays: &[Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
        avx2_sight::aim(rays, eye, aims);
    }

    #[inline(always)]
    fn meet_own(aims: &Aims, eye: &Vec3, corners: &[&Corners; RAYS], met: &mut Met) {
        avx2_sight::meet_own(aims, eye, corners, met);
    }
}
