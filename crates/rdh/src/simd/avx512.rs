//! x86-64 with AVX-512: the lanes of AVX2, compared into mask registers, and packets of sixteen rays.

use std::arch::x86_64::*;

use super::avx2::{Avx2, Frame, Sheared};
use super::avx2_approach;
use super::avx2_boxes::{WideRay, enter_and_leave, enter_and_leave_few, store_few};
use super::avx2_eight::Wide8;
use super::avx2_sight;
use super::avx512_sixteen::Wide16;
use super::{
    Aims, Block, Boxes, Corners, Entered, Entry, Indices, Job, Kernels, Met, Octet, Passing, RAYS, Shade, Sifted,
    Sight, Views,
};
use crate::geom::{Ray, RayFrame, Scale, Vec3};

/// Runs a job with AVX-512.
///
/// # Safety
/// The CPU must have AVX2, FMA, BMI1, BMI2, LZCNT, POPCNT, and AVX-512 F, VL, DQ and BW.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq,avx512bw")]
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
    type Sheared = Sheared;
    type BoxRay = WideRay;
    type Eight = Wide8;
    type Rays = Wide16;

    #[inline(always)]
    fn frame(ray: &Ray) -> Frame {
        Avx2::frame(ray)
    }

    #[inline(always)]
    fn ray_frame(frame: &Frame, interval: (f32, f32)) -> RayFrame {
        Avx2::ray_frame(frame, interval)
    }

    #[inline(always)]
    fn direction_z(frame: &Frame) -> f32 {
        Avx2::direction_z(frame)
    }

    #[inline(always)]
    fn shear(frame: &Frame, block: &Block) -> Sheared {
        Avx2::shear(frame, block)
    }

    #[inline(always)]
    fn inside(sheared: &Sheared, wanted: u32) -> u32 {
        // SAFETY: see above.
        unsafe {
            let (zero, wanted) = (_mm256_setzero_ps(), wanted as __mmask8);
            // What is not a number says nothing.
            let inside = _mm256_mask_cmp_ps_mask::<_CMP_NLT_UQ>(wanted, sheared.least, zero)
                | _mm256_mask_cmp_ps_mask::<_CMP_NGT_UQ>(wanted, sheared.most, zero);
            u32::from(inside)
        }
    }

    #[inline(always)]
    fn is_left(frame: &Frame, sheared: &Sheared, inside: u32, t_min: f32) -> bool {
        Avx2::is_left(frame, sheared, inside, t_min)
    }

    #[inline(always)]
    fn reached(frame: &Frame, sheared: &Sheared, inside: u32, interval: (f32, f32)) -> Sifted {
        Avx2::reached(frame, sheared, inside, interval)
    }

    #[inline(always)]
    fn corners(sheared: &Sheared, lane: usize) -> [Vec3; 3] {
        Avx2::corners(sheared, lane)
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
    fn approach(rays: &[Ray; RAYS], passing: &Passing, shade: &mut Shade) -> [u32; RAYS] {
        avx2_approach::approach(rays, passing, shade)
    }

    #[inline(always)]
    fn aim(rays: &[&Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
        avx2_sight::aim(rays, eye, aims);
    }

    #[inline(always)]
    fn meet_own(aims: &Aims, eye: &Vec3, corners: &[&Corners; RAYS], met: &mut Met) {
        avx2_sight::meet_own(aims, eye, corners, met);
    }
}
