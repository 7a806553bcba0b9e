//! Every CPU: the plain loops that other levels must agree with.

use super::eight::Plain8;
use super::{Block, BoxRay, Boxes, Entered, Job, Kernels, LANES, Sifted};
use crate::geom::{Ray, RayFrame, Scale, Vec3, larger, smaller};

/// Runs a job with what every CPU has. Never inlined: where it is not called, its frame would cost all the same.
#[inline(never)]
pub(super) fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Portable>()
}

/// Plain loops.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Portable;

impl Kernels for Portable {
    type Frame = RayFrame;
    type BoxRay = BoxRay;
    type Eight = Plain8;

    #[inline(always)]
    fn frames(ray: &Ray) -> (RayFrame, RayFrame) {
        let frame = RayFrame::new(ray);
        (frame, frame)
    }

    #[inline(always)]
    fn shorten(lanes: &mut RayFrame, frame: &RayFrame) {
        *lanes = *frame;
    }

    #[inline(always)]
    fn sift<const CERTAIN: bool>(frame: &RayFrame, block: &Block, wanted: u32) -> Sifted {
        let [kx, ky, kz] = frame.k;
        let (mut x, mut y, mut depth) = ([[0.0f32; LANES]; 3], [[0.0f32; LANES]; 3], [[0.0f32; LANES]; 3]);
        for c in 0..3 {
            for i in 0..LANES {
                let z = block.corners[c][kz][i] - frame.origin[2];
                depth[c][i] = z;
                x[c][i] = (block.corners[c][kx][i] - frame.origin[0]) - frame.shear[0] * z;
                y[c][i] = (block.corners[c][ky][i] - frame.origin[1]) - frame.shear[1] * z;
            }
        }
        let limits = frame.depths();
        let mut sifted = Sifted { possible: 0, certain: 0 };
        for i in 0..LANES {
            let u = x[2][i] * y[1][i] - y[2][i] * x[1][i];
            let v = x[0][i] * y[2][i] - y[0][i] * x[2][i];
            let w = x[1][i] * y[0][i] - y[1][i] * x[0][i];
            // A rounded edge function that is not 0 has the exact one's sign; 0 and NaN say nothing.
            let outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
            let inside = (u < 0.0 && v < 0.0 && w < 0.0) || (u > 0.0 && v > 0.0 && w > 0.0);
            // A hit's depth lies between those of the corners.
            let z = [depth[0][i], depth[1][i], depth[2][i]];
            let (first, last) = (smaller(smaller(z[0], z[1]), z[2]), larger(larger(z[0], z[1]), z[2]));
            let beyond = last < limits.nearest || first > limits.farthest;
            let within = first > limits.surely_from && last < limits.surely_to;
            sifted.possible |= u32::from(!(outside || beyond)) << i;
            sifted.certain |= u32::from(CERTAIN && inside && within) << i;
        }
        Sifted { possible: sifted.possible & wanted, certain: sifted.certain & wanted }
    }

    #[inline(always)]
    fn corners(ray: &RayFrame, _: &RayFrame, block: &Block, lane: usize) -> [Vec3; 3] {
        block.corners_along(lane, ray.k)
    }

    #[inline(always)]
    fn box_ray(ray: &Ray, scale: Scale, magnitude: f32) -> Option<BoxRay> {
        BoxRay::new(ray, scale, magnitude)
    }

    #[inline(always)]
    fn end(ray: &BoxRay) -> f32 {
        ray.end
    }

    #[inline(always)]
    fn end_at(ray: &mut BoxRay, t: f32) {
        ray.end = BoxRay::end_for(t, ray.t_scale);
    }

    #[inline(always)]
    fn meet<const W: usize>(ray: &BoxRay, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32 {
        let (mut near, mut far) = ([ray.t_min; W], [ray.end; W]);
        for a in 0..3 {
            let side = ray.near(a);
            let (first, last) = (&boxes.planes[side][a], &boxes.planes[side ^ 1][a]);
            for i in 0..W {
                near[i] = larger(first[i] * ray.inverse[a] + ray.enters[a], near[i]);
                far[i] = smaller(last[i] * ray.inverse[a] + ray.leaves[a], far[i]);
            }
        }
        t.0 = near;
        (0..W).fold(0, |met, i| met | u32::from(near[i] <= far[i]) << i)
    }

    #[inline(always)]
    fn count_below(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        count(values, planes, counts, |value, plane| value < plane);
    }

    #[inline(always)]
    fn count_up_to(values: &[f32], planes: &[f32], counts: &mut [u32]) {
        count(values, planes, counts, |value, plane| value <= plane);
    }

    #[inline(always)]
    fn weigh<const FROM: bool>(values: &[f32], weights: &[f32], planes: &[f32], sums: &mut [f32]) {
        sums.fill(0.0);
        for (&value, &weight) in values.iter().zip(weights) {
            for (sum, &plane) in sums.iter_mut().zip(planes) {
                let counted = if FROM { value >= plane } else { value <= plane };
                *sum += if counted { weight } else { 0.0 };
            }
        }
    }

    #[inline(always)]
    fn lower(mine: &mut [f32; 8], theirs: &[f32; 8]) {
        for i in 0..8 {
            mine[i] = smaller(theirs[i], mine[i]);
        }
    }

    #[inline(always)]
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8] {
        std::array::from_fn(|i| (((values[i] - first[i]) * scale[i]) as i32).clamp(0, last))
    }
}

#[inline(always)]
fn count(values: &[f32], planes: &[f32], counts: &mut [u32], counted: impl Fn(f32, f32) -> bool) {
    counts.fill(0);
    for &value in values {
        for (count, &plane) in counts.iter_mut().zip(planes) {
            *count += u32::from(counted(value, plane));
        }
    }
}
