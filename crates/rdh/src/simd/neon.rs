//! 64-bit ARM with NEON: eight lanes as two registers of four.

use super::arm::*;
use super::eight::Plain8;
use super::portable::Portable;
use super::reach::{self, Sheared};
use super::{Block, BoxRay, Boxes, Entered, Job, Kernels, Sifted};
use crate::geom::{Ray, RayFrame, Scale, Vec3};

/// Runs a job with NEON. Never inlined: where it is not called, its frame would cost all the same.
#[inline(never)]
pub(super) fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Neon>()
}

/// NEON.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neon;

/// A frame, and the same in registers.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    ray: RayFrame,
    origin: [F32; 3],
    shear: [F32; 2],
}

/// A [`BoxRay`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct WideRay {
    inverse: [F32; 3],
    enters: [F32; 3],
    leaves: [F32; 3],
    t_min: F32,
    end: F32,
    /// The side whose plane is met first, axis by axis.
    near: [usize; 3],
    t_scale: f64,
}

impl Kernels for Neon {
    type Frame = Frame;
    type Sheared = [Half; 2];
    type BoxRay = WideRay;
    type Eight = Plain8;
    type Rays = Plain8;

    #[inline(always)]
    fn frame(ray: &Ray) -> Frame {
        let ray = RayFrame::new(ray);
        Frame { ray, origin: ray.origin.map(vdupq_n_f32), shear: ray.shear.map(vdupq_n_f32) }
    }

    #[inline(always)]
    fn ray_frame(frame: &Frame, (t_min, t_max): (f32, f32)) -> RayFrame {
        RayFrame { t_min, t_max, ..frame.ray }
    }

    #[inline(always)]
    fn direction_z(frame: &Frame) -> f32 {
        frame.ray.direction_z
    }

    #[inline(always)]
    fn shear(frame: &Frame, block: &Block) -> [Half; 2] {
        [Half::of(frame, block, 0), Half::of(frame, block, 1)]
    }

    #[inline(always)]
    fn inside([low, high]: &[Half; 2], wanted: u32) -> u32 {
        !bits(low.outside(), high.outside()) & wanted
    }

    #[inline(always)]
    fn is_left(_: &Frame, _: &[Half; 2], _: u32, _: f32) -> bool {
        false
    }

    #[inline(always)]
    fn reached(frame: &Frame, halves: &[Half; 2], inside: u32, interval: (f32, f32)) -> Sifted {
        let one = |w: F32, lane: usize| numbers(w)[lane & 3];
        let sheared = |lane: usize| Sheared {
            w: halves[(lane / 4) & 1].w.map(|w| one(w, lane)),
            corners: Self::corners(halves, lane),
        };
        reach::reached(inside, sheared, frame.ray.direction_z, interval)
    }

    #[inline(always)]
    fn corners(halves: &[Half; 2], lane: usize) -> [Vec3; 3] {
        halves[(lane / 4) & 1].corners.map(|corner| corner.map(|x| numbers(x)[lane & 3]))
    }

    #[inline(always)]
    fn box_ray(ray: &Ray, scale: Scale, magnitude: f32) -> Option<WideRay> {
        let ray = BoxRay::new(ray, scale, magnitude)?;
        Some(WideRay {
            inverse: ray.inverse.map(vdupq_n_f32),
            enters: ray.enters.map(vdupq_n_f32),
            leaves: ray.leaves.map(vdupq_n_f32),
            t_min: vdupq_n_f32(ray.t_min),
            end: vdupq_n_f32(ray.end),
            near: [ray.near(0), ray.near(1), ray.near(2)],
            t_scale: ray.t_scale,
        })
    }

    #[inline(always)]
    fn end(ray: &WideRay) -> f32 {
        numbers(ray.end)[0]
    }

    #[inline(always)]
    fn end_at(ray: &mut WideRay, t: f32) {
        ray.end = vdupq_n_f32(BoxRay::end_for(t, ray.t_scale));
    }

    #[inline(always)]
    fn meet<const W: usize>(ray: &WideRay, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32 {
        const { assert!(W == 2 || W == 4 || W == 8, "no such boxes") }
        let low = meet_half(ray, boxes, t, 0);
        if W == 8 { bits(low, meet_half(ray, boxes, t, 1)) } else { bits(low, vdupq_n_u32(0)) & ((1 << W) - 1) }
    }

    #[inline(always)]
    fn count_below(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        count(values, planes, counts, vcltq_f32);
    }

    #[inline(always)]
    fn count_up_to(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        count(values, planes, counts, vcleq_f32);
    }

    #[inline(always)]
    fn weigh<const FROM: bool>(values: &[f32], weights: &[f32], planes: &[f32], sums: &mut [f32]) {
        let ((planes, few_planes), (sums, few_sums)) = (planes.as_chunks::<4>(), sums.as_chunks_mut::<4>());
        for (planes, sums) in planes.iter().zip(sums) {
            let (planes, mut sum) = (load(planes), vdupq_n_f32(0.0));
            for (&value, &weight) in values.iter().zip(weights) {
                let value = vdupq_n_f32(value);
                let counted = if FROM { vcgeq_f32(value, planes) } else { vcleq_f32(value, planes) };
                let weight = vandq_u32(counted, vreinterpretq_u32_f32(vdupq_n_f32(weight)));
                sum = vaddq_f32(sum, vreinterpretq_f32_u32(weight));
            }
            *sums = numbers(sum);
        }
        Portable::weigh::<FROM>(values, weights, few_planes, few_sums);
    }

    #[inline(always)]
    fn lower(mine: &mut [f32; 8], theirs: &[f32; 8]) {
        for (mine, theirs) in mine.as_chunks_mut::<4>().0.iter_mut().zip(theirs.as_chunks::<4>().0) {
            *mine = numbers(vminq_f32(load(theirs), load(mine)));
        }
    }

    #[inline(always)]
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8] {
        let mut out = [0; 8];
        for (half, out) in out.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let offset = vsubq_f32(load_half(values, half), load_half(first, half));
            let bins = vcvtq_s32_f32(vmulq_f32(offset, load_half(scale, half)));
            *out = numbers_i32(vminq_s32(vmaxq_s32(bins, vdupq_n_s32(0)), vdupq_n_s32(last)));
        }
        out
    }
}

/// Four triangles in the ray's frame.
#[derive(Clone, Copy)]
pub(crate) struct Half {
    /// Edge functions.
    w: [F32; 3],
    corners: [[F32; 3]; 3],
}

impl Half {
    #[inline(always)]
    fn of(frame: &Frame, block: &Block, half: usize) -> Self {
        let [a, b, c] = [0, 1, 2].map(|corner| shear(frame, &block.corners[corner], half));
        Self { w: [cross(c, b), cross(a, c), cross(b, a)], corners: [a, b, c] }
    }

    /// Which of them the ray's line surely passes by: all bits of a lane, or none.
    #[inline(always)]
    fn outside(&self) -> U32 {
        let [u, v, w] = self.w;
        // If one is not a number, neither is the least or the most, which then say nothing.
        let (least, most) = (vminq_f32(vminq_f32(u, v), w), vmaxq_f32(vmaxq_f32(u, v), w));
        vandq_u32(vcltzq_f32(least), vcgtzq_f32(most))
    }
}

/// Four corners in the ray's frame: sheared x and y, and depth; separate products and differences, as THE triangle test rounds.
#[inline(always)]
fn shear(frame: &Frame, corner: &[[f32; 8]; 3], half: usize) -> [F32; 3] {
    let [x, y, z] = frame.ray.k.map(|axis| load_half(&corner[axis.min(2)], half));
    let z = vsubq_f32(z, frame.origin[2]);
    let x = vsubq_f32(vsubq_f32(x, frame.origin[0]), vmulq_f32(frame.shear[0], z));
    let y = vsubq_f32(vsubq_f32(y, frame.origin[1]), vmulq_f32(frame.shear[1], z));
    [x, y, z]
}

#[inline(always)]
fn cross(a: [F32; 3], b: [F32; 3]) -> F32 {
    vsubq_f32(vmulq_f32(a[0], b[1]), vmulq_f32(a[1], b[0]))
}

/// Which of four boxes, or of two, the ray meets, and where it enters them.
#[inline(always)]
fn meet_half<const W: usize>(ray: &WideRay, boxes: &Boxes<W>, t: &mut Entered<W>, half: usize) -> U32 {
    let (mut near, mut far) = (ray.t_min, ray.end);
    for a in 0..3 {
        let side = ray.near[a] & 1;
        let (first, last) = (load_half(&boxes.planes[side][a], half), load_half(&boxes.planes[side ^ 1][a], half));
        near = vmaxq_f32(vfmaq_f32(ray.enters[a], first, ray.inverse[a]), near);
        far = vminq_f32(vfmaq_f32(ray.leaves[a], last, ray.inverse[a]), far);
    }
    let lanes = 4.min(W);
    t.0[4 * half..][..lanes].copy_from_slice(&numbers(near)[..lanes]);
    vcleq_f32(near, far)
}

/// For each plane, how many values are `counted`.
#[inline(always)]
fn count(values: &[f32], planes: &[f32], counts: &mut [u32], counted: impl Fn(F32, F32) -> U32) {
    for (planes, counts) in planes.as_chunks::<4>().0.iter().zip(counts.as_chunks_mut::<4>().0) {
        let (planes, mut sum) = (load(planes), vdupq_n_u32(0));
        for &value in values {
            // All bits of a lane together are −1.
            sum = vsubq_u32(sum, counted(vdupq_n_f32(value), planes));
        }
        *counts = numbers_u32(sum);
    }
}

/// A bit a lane.
#[inline(always)]
fn bits(low: U32, high: U32) -> u32 {
    let (low, high) = (vandq_u32(low, load_u32(&[1, 2, 4, 8])), vandq_u32(high, load_u32(&[16, 32, 64, 128])));
    vaddvq_u32(vorrq_u32(low, high))
}

/// Half a row of eight; of shorter rows all, and zeros.
#[inline(always)]
fn load_half<const W: usize>(row: &[f32; W], half: usize) -> F32 {
    let mut four = [0.0; 4];
    let lanes = 4.min(W);
    four[..lanes].copy_from_slice(&row[4 * half..][..lanes]);
    load(&four)
}
