//! Every CPU: the plain loops that other levels must agree with.

use super::eight::Plain8;
use super::reach::{self, Sheared};
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

/// Eight triangles in a ray's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Eight {
    /// `corners[axis][corner][lane]`.
    corners: [[[f32; LANES]; 3]; 3],
    /// Edge functions, `w[corner][lane]`.
    w: [[f32; LANES]; 3],
}

impl Kernels for Portable {
    type Frame = RayFrame;
    type Sheared = Eight;
    type BoxRay = BoxRay;
    type Eight = Plain8;
    type Rays = Plain8;
    const PACKETS: bool = false;

    #[inline(always)]
    fn frame(ray: &Ray) -> RayFrame {
        RayFrame::new(ray)
    }

    #[inline(always)]
    fn ray_frame(frame: &RayFrame, (t_min, t_max): (f32, f32)) -> RayFrame {
        RayFrame { t_min, t_max, ..*frame }
    }

    #[inline(always)]
    fn direction_z(frame: &RayFrame) -> f32 {
        frame.direction_z
    }

    #[inline(always)]
    fn shear(frame: &RayFrame, block: &Block) -> Eight {
        let [kx, ky, kz] = frame.k;
        let (mut x, mut y, mut z) = ([[0.0f32; LANES]; 3], [[0.0f32; LANES]; 3], [[0.0f32; LANES]; 3]);
        for c in 0..3 {
            for i in 0..LANES {
                let depth = block.corners[c][kz][i] - frame.origin[2];
                z[c][i] = depth;
                x[c][i] = (block.corners[c][kx][i] - frame.origin[0]) - frame.shear[0] * depth;
                y[c][i] = (block.corners[c][ky][i] - frame.origin[1]) - frame.shear[1] * depth;
            }
        }
        let mut w = [[0.0f32; LANES]; 3];
        for i in 0..LANES {
            w[0][i] = x[2][i] * y[1][i] - y[2][i] * x[1][i];
            w[1][i] = x[0][i] * y[2][i] - y[0][i] * x[2][i];
            w[2][i] = x[1][i] * y[0][i] - y[1][i] * x[0][i];
        }
        Eight { corners: [x, y, z], w }
    }

    #[inline(always)]
    fn inside(Eight { w: [u, v, w], .. }: &Eight, wanted: u32) -> u32 {
        // A rounded edge function that is not 0 has the exact one's sign; 0 and NaN say nothing.
        let below = |i: usize| u[i] < 0.0 || v[i] < 0.0 || w[i] < 0.0;
        let above = |i: usize| u[i] > 0.0 || v[i] > 0.0 || w[i] > 0.0;
        let outside = (0..LANES).fold(0, |outside, i| outside | u32::from(below(i) && above(i)) << i);
        !outside & wanted
    }

    #[inline(always)]
    fn is_left(_: &RayFrame, _: &Eight, _: u32, _: f32) -> bool {
        false
    }

    #[inline(always)]
    fn reached(frame: &RayFrame, eight: &Eight, inside: u32, interval: (f32, f32)) -> Sifted {
        let sheared = |i: usize| Sheared { w: eight.w.map(|w| w[i]), corners: Self::corners(eight, i) };
        reach::reached(inside, sheared, frame.direction_z, interval)
    }

    #[inline(always)]
    fn corners(Eight { corners: [x, y, z], .. }: &Eight, lane: usize) -> [Vec3; 3] {
        let i = lane & (LANES - 1);
        [[x[0][i], y[0][i], z[0][i]], [x[1][i], y[1][i], z[1][i]], [x[2][i], y[2][i], z[2][i]]]
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
