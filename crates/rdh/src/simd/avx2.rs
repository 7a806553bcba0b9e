//! x86-64 with AVX2 and FMA: eight lanes at once.

use std::arch::x86_64::*;

use super::avx2_approach;
use super::avx2_boxes::{WideRay, enter_and_leave, enter_and_leave_few, store_few};
use super::avx2_eight::Wide8;
use super::avx2_sight;
use super::portable::Portable;
use super::reach::reached_side_by_side;
use super::{
    Aims, Block, Boxes, Corners, Entered, Entry, Floats, Indices, Job, Kernels, LANES, Met, Octet, Passing, RAYS,
    Shade, Sifted, Sight, Views,
};
use crate::geom::{Ray, RayFrame, Scale, Vec3};

/// Runs a job with AVX2.
///
/// # Safety
/// The CPU must have AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Avx2>()
}

/// AVX2. Named only in [`enter`] and by AVX-512, which needs AVX2 too: the kernels run nowhere else.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx2;

/// A frame as it waits in memory until a leaf is met: from there a number gets into all lanes as fast as a register would come back.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct Frame {
    /// The origin along the frame's axes, negated: adding it takes the corners from memory, subtracting the origin would not.
    back: [f32; 4],
    /// The shear along x and y, and 1.
    shear: [f32; 4],
    /// The direction along the frame's axes.
    direction: [f32; 4],
    axes: &'static Axes,
}

// SAFETY, for every block below: `Avx2` is named only in `enter` and in `avx512.rs`, whose `enter` asks for AVX2 as well; callers of
// both have made sure of the instructions. Loads and stores lie within the references they are made from, and are unaligned ones
// but where the block says otherwise.
impl Kernels for Avx2 {
    type Frame = Frame;
    type Sheared = Sheared;
    type BoxRay = WideRay;
    type Eight = Wide8;
    type Rays = Wide8;

    #[inline(always)]
    fn frame(ray: &Ray) -> Frame {
        frame(ray)
    }

    #[inline(always)]
    fn ray_frame(frame: &Frame, (t_min, t_max): (f32, f32)) -> RayFrame {
        let ([x, y, z, _], [shear_x, shear_y, ..]) = (frame.back, frame.shear);
        let direction_z = frame.direction[2];
        RayFrame { k: frame.axes.k, origin: [-x, -y, -z], shear: [shear_x, shear_y], direction_z, t_min, t_max }
    }

    #[inline(always)]
    fn direction_z(frame: &Frame) -> f32 {
        frame.direction[2]
    }

    #[inline(always)]
    fn shear(frame: &Frame, block: &Block) -> Sheared {
        Sheared::new(frame, block)
    }

    #[inline(always)]
    fn inside(sheared: &Sheared, wanted: u32) -> u32 {
        // SAFETY: see above.
        unsafe {
            let zero = _mm256_setzero_ps();
            // What is not a number says nothing.
            let below = _mm256_cmp_ps::<_CMP_LT_OQ>(sheared.least, zero);
            let above = _mm256_cmp_ps::<_CMP_GT_OQ>(sheared.most, zero);
            !(_mm256_movemask_ps(_mm256_and_ps(below, above)) as u32) & wanted
        }
    }

    #[inline(always)]
    fn is_left(frame: &Frame, Sheared { corners: [a, b, c], .. }: &Sheared, inside: u32, t_min: f32) -> bool {
        // SAFETY: see above.
        unsafe {
            let direction = _mm256_broadcast_ss(&frame.direction[2]);
            let start = _mm256_mul_ps(direction, _mm256_set1_ps(t_min));
            // Where one of these differences is negative, turned along the ray, the corner lies before the start.
            let (a, b, c) = (_mm256_sub_ps(a.2, start), _mm256_sub_ps(b.2, start), _mm256_sub_ps(c.2, start));
            let (a, b, c) = (_mm256_xor_ps(a, direction), _mm256_xor_ps(b, direction), _mm256_xor_ps(c, direction));
            _mm256_movemask_ps(_mm256_or_ps(_mm256_or_ps(a, b), c)) as u32 & inside != 0
        }
    }

    #[inline(always)]
    fn reached(frame: &Frame, sheared: &Sheared, inside: u32, interval: (f32, f32)) -> Sifted {
        sheared.reached(frame, inside, interval)
    }

    #[inline(always)]
    fn corners(sheared: &Sheared, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = sheared.corners;
        [one(a, lane), one(b, lane), one(c, lane)]
    }

    #[inline(always)]
    fn gather(points: &[Vec3], indices: &Indices, block: &mut Block) {
        if !can_gather(points, indices) {
            return gather_plainly(points, indices, block);
        }
        for (corner, vertices) in block.corners.iter_mut().zip(&indices.corners) {
            // SAFETY: see above; no vertex is the last one, nor beyond it.
            unsafe { gather_corner(points, vertices, corner) };
        }
        block.ids = indices.ids;
    }

    #[inline(always)]
    fn box_ray(ray: &Ray, scale: Scale, magnitude: f32) -> Option<WideRay> {
        WideRay::of(ray, scale, magnitude)
    }

    #[inline(always)]
    fn end(ray: &WideRay) -> f32 {
        ray.end()
    }

    #[inline(always)]
    fn end_at(ray: &mut WideRay, t: f32) {
        ray.end_at(t);
    }

    #[inline(always)]
    fn meet<const W: usize>(ray: &WideRay, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32 {
        const { assert!(W == 2 || W == 4 || W == 8, "no such boxes") }
        // SAFETY: see above; `W` is 2, 4 or 8. Eight lanes are stored aligned: `t` has as many, and is aligned to 32 bytes.
        unsafe {
            if W == 8 {
                let (near, far) = enter_and_leave(ray, boxes);
                _mm256_store_ps(t.0.as_mut_ptr(), near);
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32
            } else {
                let (near, far) = enter_and_leave_few(ray, boxes);
                store_few(t, near);
                _mm_movemask_ps(_mm_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32 & ((1 << W) - 1)
            }
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
    fn weigh<const FROM: bool>(values: &[f32], weights: &[f32], planes: &[f32], sums: &mut [f32]) {
        let whole = planes.len() / 8 * 8;
        for (planes, sums) in planes.chunks_exact(8).zip(sums.chunks_exact_mut(8)) {
            // SAFETY: see above; both chunks have eight elements.
            unsafe {
                let planes = _mm256_loadu_ps(planes.as_ptr());
                let mut sum = _mm256_setzero_ps();
                for (&value, &weight) in values.iter().zip(weights) {
                    let value = _mm256_set1_ps(value);
                    let counted = if FROM {
                        _mm256_cmp_ps::<_CMP_GE_OQ>(value, planes)
                    } else {
                        _mm256_cmp_ps::<_CMP_LE_OQ>(value, planes)
                    };
                    sum = _mm256_add_ps(sum, _mm256_and_ps(counted, _mm256_set1_ps(weight)));
                }
                _mm256_storeu_ps(sums.as_mut_ptr(), sum);
            }
        }
        Portable::weigh::<FROM>(values, weights, &planes[whole..], &mut sums[whole..]);
    }

    #[inline(always)]
    fn lower(mine: &mut [f32; 8], theirs: &[f32; 8]) {
        // SAFETY: see above; both arrays have eight elements.
        unsafe {
            let lower = _mm256_min_ps(_mm256_loadu_ps(theirs.as_ptr()), _mm256_loadu_ps(mine.as_ptr()));
            _mm256_storeu_ps(mine.as_mut_ptr(), lower);
        }
    }

    #[inline(always)]
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8] {
        let mut out = [0; 8];
        // SAFETY: see above; all arrays have eight elements.
        unsafe {
            let offset = _mm256_sub_ps(_mm256_loadu_ps(values.as_ptr()), _mm256_loadu_ps(first.as_ptr()));
            let bins = _mm256_cvttps_epi32(_mm256_mul_ps(offset, _mm256_loadu_ps(scale.as_ptr())));
            let bins = _mm256_min_epi32(_mm256_max_epi32(bins, _mm256_setzero_si256()), _mm256_set1_epi32(last));
            _mm256_storeu_si256(out.as_mut_ptr().cast(), bins);
        }
        out
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

/// The axes of a frame: where their rows begin in a corner's part of a block, and their lanes.
#[derive(Clone, Copy)]
struct Axes {
    k: [usize; 3],
    rows: [usize; 3],
    lanes: [i32; 4],
}

impl Axes {
    const fn new(x: usize, y: usize, z: usize) -> Self {
        let lanes = [x as i32, y as i32, z as i32, z as i32];
        Self { k: [x, y, z], rows: [x * LANES, y * LANES, z * LANES], lanes }
    }
}

/// If the ray moves most along x, y or z.
const X: Axes = Axes::new(1, 2, 0);
const Y: Axes = Axes::new(2, 0, 1);
const Z: Axes = Axes::new(0, 1, 2);
/// The frame's axes, from three comparisons of components' sizes: bit 0 x > y, bit 1 y > z, bit 2 x > z.
static AXES: [Axes; 8] = [Z, Z, Y, Y, Z, X, Y, X];

/// [`RayFrame::new`] without a branch: which component is the longest is as good as random.
#[inline(always)]
fn frame(ray: &Ray) -> Frame {
    let mut frame = Frame { back: [0.0; 4], shear: [0.0; 4], direction: [0.0; 4], axes: &Z };
    // SAFETY: as in `Avx2`; a ray begins with seven floats, in this order: origin, direction and `t_min`. Four are stored to each array.
    unsafe {
        let p = std::ptr::from_ref(ray).cast::<f32>();
        let (origin, direction) = (_mm_loadu_ps(p), _mm_loadu_ps(p.add(3)));
        let size = _mm_andnot_ps(_mm_set1_ps(-0.0), direction);
        // x > y, y > z, and x > z in lane 2.
        let these = _mm_shuffle_ps::<0b00_00_01_00>(size, size);
        let those = _mm_shuffle_ps::<0b10_10_10_01>(size, size);
        let longer = _mm_movemask_ps(_mm_cmpgt_ps(these, those)) as usize & 7;
        frame.axes = &AXES[longer];
        let order = _mm_loadu_si128(frame.axes.lanes.as_ptr().cast());
        let (o, d) = (_mm_permutevar_ps(origin, order), _mm_permutevar_ps(direction, order));
        _mm_storeu_ps(frame.back.as_mut_ptr(), _mm_xor_ps(_mm_set1_ps(-0.0), o));
        _mm_storeu_ps(frame.shear.as_mut_ptr(), _mm_div_ps(d, _mm_shuffle_ps::<0b10_10_10_10>(d, d)));
        _mm_storeu_ps(frame.direction.as_mut_ptr(), d);
    }
    frame
}

/// Four floats, in both halves of a register.
///
/// # Safety
/// As in `Avx2`; at `p` there are four floats.
#[inline(always)]
pub(super) unsafe fn load_twice(p: *const f32) -> __m256 {
    // SAFETY: see above.
    unsafe { _mm256_castsi256_ps(_mm256_broadcastsi128_si256(_mm_castps_si128(_mm_loadu_ps(p)))) }
}

/// Each of the first three lanes, spread over a register whose halves are equal.
#[inline(always)]
pub(super) fn spread_axes(v: __m256) -> [__m256; 3] {
    // SAFETY: as in `Avx2`.
    unsafe {
        [
            _mm256_permute_ps::<0b00_00_00_00>(v),
            _mm256_permute_ps::<0b01_01_01_01>(v),
            _mm256_permute_ps::<0b10_10_10_10>(v),
        ]
    }
}

// Functions instead of closures: intrinsics inside a closure are compiled without AVX2 and become calls.

/// Eight triangles in a ray's frame.
#[derive(Clone, Copy)]
pub(crate) struct Sheared {
    corners: [(__m256, __m256, __m256); 3],
    /// Edge functions.
    w: [__m256; 3],
    /// The smallest and the largest of them.
    pub(super) least: __m256,
    pub(super) most: __m256,
}

impl Sheared {
    #[inline(always)]
    fn new(frame: &Frame, block: &Block) -> Self {
        let [a, b, c] = &block.corners;
        let (a, b, c) = (shear(frame, a), shear(frame, b), shear(frame, c));
        let (u, v, w) = (cross(c, b), cross(a, c), cross(b, a));
        // SAFETY: as in `Avx2`.
        unsafe {
            Self {
                corners: [a, b, c],
                w: [u, v, w],
                least: _mm256_min_ps(_mm256_min_ps(u, v), w),
                most: _mm256_max_ps(_mm256_max_ps(u, v), w),
            }
        }
    }

    /// What [`reached_side_by_side`] says.
    #[inline(always)]
    fn reached(&self, frame: &Frame, inside: u32, (t_min, t_max): (f32, f32)) -> Sifted {
        let ([u, v, w], [a, b, c]) = (self.w, self.corners);
        let reached = reached_side_by_side(
            &[Wide8(u), Wide8(v), Wide8(w)],
            (Wide8(self.least), Wide8(self.most)),
            &[wide(a), wide(b), wide(c)],
            Wide8::splat(frame.direction[2]),
            (Wide8::splat(t_min), Wide8::splat(t_max)),
        );
        Sifted { possible: reached.possible & inside, certain: reached.certain & inside }
    }
}

/// A corner of eight triangles.
#[inline(always)]
fn wide((x, y, z): (__m256, __m256, __m256)) -> [Wide8; 3] {
    [Wide8(x), Wide8(y), Wide8(z)]
}

/// One of eight corners.
#[inline(always)]
fn one((x, y, z): (__m256, __m256, __m256), lane: usize) -> Vec3 {
    // SAFETY: as in `Avx2`.
    unsafe {
        let lane = _mm256_castsi128_si256(_mm_cvtsi32_si128(lane as i32));
        [
            _mm256_cvtss_f32(_mm256_permutevar8x32_ps(x, lane)),
            _mm256_cvtss_f32(_mm256_permutevar8x32_ps(y, lane)),
            _mm256_cvtss_f32(_mm256_permutevar8x32_ps(z, lane)),
        ]
    }
}

/// Eight corners in the ray's frame: sheared x and y, and depth.
#[inline(always)]
fn shear(frame: &Frame, corner: &[[f32; 8]; 3]) -> (__m256, __m256, __m256) {
    let ([x, y, z], p) = (frame.axes.rows, corner.as_ptr().cast::<f32>());
    // SAFETY: as in `Avx2`; a corner has three rows of eight floats, and a frame's rows begin at 16 at most.
    unsafe {
        let z = _mm256_add_ps(_mm256_broadcast_ss(&frame.back[2]), _mm256_loadu_ps(p.add(z)));
        let x = _mm256_add_ps(_mm256_broadcast_ss(&frame.back[0]), _mm256_loadu_ps(p.add(x)));
        let y = _mm256_add_ps(_mm256_broadcast_ss(&frame.back[1]), _mm256_loadu_ps(p.add(y)));
        let (shear_x, shear_y) = (_mm256_broadcast_ss(&frame.shear[0]), _mm256_broadcast_ss(&frame.shear[1]));
        (_mm256_sub_ps(x, _mm256_mul_ps(shear_x, z)), _mm256_sub_ps(y, _mm256_mul_ps(shear_y, z)), z)
    }
}

#[inline(always)]
fn cross(a: (__m256, __m256, __m256), b: (__m256, __m256, __m256)) -> __m256 {
    // SAFETY: as in `Avx2`.
    unsafe { _mm256_sub_ps(_mm256_mul_ps(a.0, b.1), _mm256_mul_ps(a.1, b.0)) }
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

/// Whether all vertices come before the last one: then four floats can be read at each.
#[inline(always)]
fn can_gather(points: &[Vec3], indices: &Indices) -> bool {
    let Some(last) = points.len().checked_sub(2).and_then(|last| u32::try_from(last).ok()) else { return false };
    let [a, b, c] = &indices.corners;
    // SAFETY: as in `Avx2`; each row has eight numbers.
    unsafe {
        let (a, b) = (_mm256_loadu_si256(a.as_ptr().cast()), _mm256_loadu_si256(b.as_ptr().cast()));
        let most = _mm256_max_epu32(_mm256_max_epu32(a, b), _mm256_loadu_si256(c.as_ptr().cast()));
        let last = _mm256_set1_epi32(last as i32);
        _mm256_movemask_epi8(_mm256_cmpeq_epi32(_mm256_max_epu32(most, last), last)) == -1
    }
}

#[cold]
#[inline(never)]
fn gather_plainly(points: &[Vec3], indices: &Indices, block: &mut Block) {
    indices.copy_to(points, block);
}

/// Eight vertices, coordinate by coordinate.
///
/// # Safety
/// As in `Avx2`; behind each vertex there is another one.
#[inline(always)]
unsafe fn gather_corner(points: &[Vec3], vertices: &[u32; LANES], corner: &mut [[f32; LANES]; 3]) {
    let p = points.as_ptr().cast::<f32>();
    // SAFETY: see above: four floats can be read at each vertex; a corner has three rows of eight.
    unsafe {
        let (a, b) = (pair(p, vertices[0], vertices[4]), pair(p, vertices[1], vertices[5]));
        let (c, d) = (pair(p, vertices[2], vertices[6]), pair(p, vertices[3], vertices[7]));
        let (low_ab, low_cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
        let (high_ab, high_cd) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
        _mm256_storeu_ps(corner[0].as_mut_ptr(), _mm256_shuffle_ps::<0b01_00_01_00>(low_ab, low_cd));
        _mm256_storeu_ps(corner[1].as_mut_ptr(), _mm256_shuffle_ps::<0b11_10_11_10>(low_ab, low_cd));
        _mm256_storeu_ps(corner[2].as_mut_ptr(), _mm256_shuffle_ps::<0b01_00_01_00>(high_ab, high_cd));
    }
}

/// Two vertices in the halves of a register, each with what lies behind it.
///
/// # Safety
/// As in `gather_corner`.
#[inline(always)]
unsafe fn pair(p: *const f32, low: u32, high: u32) -> __m256 {
    // SAFETY: see above.
    unsafe { _mm256_loadu2_m128(p.add(3 * high as usize), p.add(3 * low as usize)) }
}
