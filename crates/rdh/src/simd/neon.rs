//! 64-bit ARM with NEON: eight lanes as two registers of four.

use super::eight::Plain8;
use super::arm::*;
use super::portable::Portable;
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

/// A frame in registers.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    /// The axes that become x, y and z.
    axes: [usize; 3],
    origin: [F32; 3],
    shear: [F32; 2],
    limits: Limits,
}

/// [`Depths`](crate::geom::Depths) in registers.
#[derive(Clone, Copy)]
struct Limits {
    nearest: F32,
    farthest: F32,
    surely_from: F32,
    surely_to: F32,
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
    type BoxRay = WideRay;
    type Eight = Plain8;

    #[inline(always)]
    fn frames(ray: &Ray) -> (RayFrame, Frame) {
        let frame = RayFrame::new(ray);
        let (origin, shear) = (frame.origin.map(vdupq_n_f32), frame.shear.map(vdupq_n_f32));
        (frame, Frame { axes: frame.k, origin, shear, limits: Limits::of(&frame) })
    }

    #[inline(always)]
    fn shorten(lanes: &mut Frame, frame: &RayFrame) {
        lanes.limits = Limits::of(frame);
    }

    #[inline(always)]
    fn sift<const CERTAIN: bool>(frame: &Frame, block: &Block, wanted: u32) -> Sifted {
        let (low, high) = (sift_half::<CERTAIN>(frame, block, 0), sift_half::<CERTAIN>(frame, block, 1));
        let possible = !bits(low.impossible, high.impossible) & wanted;
        Sifted { possible, certain: if CERTAIN { bits(low.certain, high.certain) & wanted } else { 0 } }
    }

    #[inline(always)]
    fn corners(ray: &RayFrame, _: &Frame, block: &Block, lane: usize) -> [Vec3; 3] {
        block.corners_along(lane, ray.k)
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

impl Limits {
    #[inline(always)]
    fn of(frame: &RayFrame) -> Self {
        let depths = frame.depths();
        Self {
            nearest: vdupq_n_f32(depths.nearest),
            farthest: vdupq_n_f32(depths.farthest),
            surely_from: vdupq_n_f32(depths.surely_from),
            surely_to: vdupq_n_f32(depths.surely_to),
        }
    }
}

/// What four triangles have to do with a ray: all bits of a lane, or none.
struct Half {
    impossible: U32,
    certain: U32,
}

#[inline(always)]
fn sift_half<const CERTAIN: bool>(frame: &Frame, block: &Block, half: usize) -> Half {
    let [a, b, c] = [0, 1, 2].map(|corner| shear(frame, &block.corners[corner], half));
    let (u, v, w) = (cross(c, b), cross(a, c), cross(b, a));
    // If one is not a number, neither is the least or the most, which then say nothing.
    let (least, most) = (vminq_f32(vminq_f32(u, v), w), vmaxq_f32(vmaxq_f32(u, v), w));
    let (first, last) = (vminq_f32(vminq_f32(a[2], b[2]), c[2]), vmaxq_f32(vmaxq_f32(a[2], b[2]), c[2]));
    let Limits { nearest, farthest, surely_from, surely_to } = frame.limits;
    // A hit's depth lies between those of the corners.
    let outside = vandq_u32(vcltzq_f32(least), vcgtzq_f32(most));
    let beyond = vorrq_u32(vcltq_f32(last, nearest), vcgtq_f32(first, farthest));
    let impossible = vorrq_u32(outside, beyond);
    if !CERTAIN {
        return Half { impossible, certain: vdupq_n_u32(0) };
    }
    let inside = vorrq_u32(vcgtzq_f32(least), vcltzq_f32(most));
    let within = vandq_u32(vcgtq_f32(first, surely_from), vcltq_f32(last, surely_to));
    Half { impossible, certain: vandq_u32(inside, within) }
}

/// Four corners in the ray's frame: sheared x and y, and depth; separate products and differences, as THE triangle test rounds.
#[inline(always)]
fn shear(frame: &Frame, corner: &[[f32; 8]; 3], half: usize) -> [F32; 3] {
    let [x, y, z] = frame.axes.map(|axis| load_half(&corner[axis.min(2)], half));
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
