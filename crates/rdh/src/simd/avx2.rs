//! x86-64 with AVX2 and FMA: eight lanes at once.

use std::arch::x86_64::*;

use super::avx2_boxes::{WideRay, enter_and_leave, enter_and_leave_few, store_few};
use super::avx2_sight;
use super::portable::Portable;
use super::{
    Aims, Block, Boxes, Corners, Entered, Entry, Indices, Job, Kernels, LANES, Met, Octet, RAYS, Shade, Sifted, Sight,
    Views,
};
use crate::geom::{Depths, Ray, RayFrame, Scale, Vec3};

/// Runs a job with AVX2.
///
/// # Safety
/// The CPU must have AVX2, FMA, BMI1 and BMI2.
#[target_feature(enable = "avx2,fma,bmi1,bmi2")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run::<Avx2>()
}

/// AVX2. Named only in [`enter`] and by AVX-512, which needs AVX2 too: the kernels run nowhere else.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx2;

/// A frame in registers.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    /// Where a corner's coordinates along the frame's axes begin: 0, 8 and 16 in some order.
    rows: [usize; 3],
    /// The origin, negated: adding it takes its operand from memory, subtracting the origin would not.
    back: [__m256; 3],
    shear: [__m256; 2],
    direction_z: __m256,
    pub(super) limits: Limits,
}

/// [`Depths`] in registers.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) nearest: __m256,
    pub(super) farthest: __m256,
    pub(super) surely_from: __m256,
    pub(super) surely_to: __m256,
    /// That of the first two which lies before the ray's start, …
    pub(super) start: __m256,
    /// … and the sign of the direction from there.
    ahead: __m256,
}

// SAFETY, for every block below: `Avx2` is named only in `enter` and in `avx512.rs`, whose `enter` asks for AVX2 as well; callers of
// both have made sure of the instructions. Loads and stores lie within the references they are made from, and are unaligned ones
// but where the block says otherwise.
impl Kernels for Avx2 {
    type Frame = Frame;
    type BoxRay = WideRay;

    #[inline(always)]
    fn frames(ray: &Ray) -> (RayFrame, Frame) {
        frames(ray)
    }

    #[inline(always)]
    fn shorten(lanes: &mut Frame, frame: &RayFrame) {
        // SAFETY: see above.
        lanes.limits = unsafe { limits(_mm256_set1_ps(frame.t_min), _mm256_set1_ps(frame.t_max), lanes.direction_z) };
    }

    #[inline(always)]
    fn sift<const CERTAIN: bool>(frame: &Frame, block: &Block, wanted: u32) -> Sifted {
        let spans = spans(frame, block);
        let Spans { least, most, first, last, .. } = spans;
        // SAFETY: see above.
        unsafe {
            let zero = _mm256_setzero_ps();
            // A hit's depth lies between those of the corners. What is not a number says nothing.
            let outside =
                _mm256_and_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(least, zero), _mm256_cmp_ps::<_CMP_GT_OQ>(most, zero));
            let beyond = _mm256_or_ps(
                _mm256_cmp_ps::<_CMP_LT_OQ>(last, frame.limits.nearest),
                _mm256_cmp_ps::<_CMP_GT_OQ>(first, frame.limits.farthest),
            );
            let mut possible = !(_mm256_movemask_ps(_mm256_or_ps(outside, beyond)) as u32) & wanted;
            // Any-hit rays mostly come from a surface: to ask whether it matters would cost them more.
            let start = frame.limits.start;
            let both_sides =
                _mm256_and_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(first, start), _mm256_cmp_ps::<_CMP_GT_OQ>(last, start));
            if CERTAIN || _mm256_movemask_ps(both_sides) as u32 & wanted != 0 {
                let before = _mm256_cmp_ps::<_CMP_LT_OQ>(spans.before_start(frame), zero);
                possible &= !(_mm256_movemask_ps(before) as u32);
            }
            if !CERTAIN {
                return Sifted { possible, certain: 0 };
            }
            let sum = spans.sum();
            let inside =
                _mm256_or_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(least, zero), _mm256_cmp_ps::<_CMP_LT_OQ>(most, zero));
            let within = _mm256_and_ps(
                _mm256_cmp_ps::<_CMP_GT_OQ>(first, frame.limits.surely_from),
                _mm256_cmp_ps::<_CMP_LT_OQ>(last, frame.limits.surely_to),
            );
            let inside = _mm256_and_ps(inside, _mm256_cmp_ps::<_CMP_ORD_Q>(sum, sum));
            Sifted { possible, certain: _mm256_movemask_ps(_mm256_and_ps(inside, within)) as u32 & wanted }
        }
    }

    #[inline(always)]
    fn corners(_: &RayFrame, frame: &Frame, block: &Block, lane: usize) -> [Vec3; 3] {
        let (p, lane) = (block.corners.as_ptr().cast::<f32>(), lane & (LANES - 1));
        let [x, y, z] = frame.rows;
        // SAFETY: a block has three corners of three rows of eight floats; a lane is at most 7, and a frame's rows begin at 16 at most.
        unsafe {
            let (x, y, z) = (p.add(x + lane), p.add(y + lane), p.add(z + lane));
            const NEXT: usize = 3 * LANES;
            [
                [*x, *y, *z],
                [*x.add(NEXT), *y.add(NEXT), *z.add(NEXT)],
                [*x.add(2 * NEXT), *y.add(2 * NEXT), *z.add(2 * NEXT)],
            ]
        }
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
    fn aim(rays: &[Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
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

/// [`RayFrame::new`] without a branch: which component is the longest is as good as random. Both halves of a register do the same.
#[inline(always)]
fn frames(ray: &Ray) -> (RayFrame, Frame) {
    // SAFETY: as in `Avx2`; a ray begins with seven floats, in this order: origin, direction and `t_min`.
    unsafe {
        let p = std::ptr::from_ref(ray).cast::<f32>();
        let (origin, direction) = (load_twice(p), load_twice(p.add(3)));
        let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), direction);
        // x > y, y > z, and x > z in lane 2.
        let these = _mm256_shuffle_ps::<0b00_00_01_00>(size, size);
        let those = _mm256_shuffle_ps::<0b10_10_10_01>(size, size);
        let longer = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(these, those)) as usize & 7;
        let axes = &AXES[longer];
        let order = _mm256_castps_si256(load_twice(axes.lanes.as_ptr().cast()));
        let (o, d) = (_mm256_permutevar_ps(origin, order), _mm256_permutevar_ps(direction, order));
        let direction_z = _mm256_permute_ps::<0b10_10_10_10>(d);
        let shear = _mm256_div_ps(d, direction_z);
        let (back, [shear_x, shear_y, _]) = (spread_axes(_mm256_xor_ps(_mm256_set1_ps(-0.0), o)), spread_axes(shear));
        let frame = RayFrame {
            k: axes.k,
            origin: [-_mm256_cvtss_f32(back[0]), -_mm256_cvtss_f32(back[1]), -_mm256_cvtss_f32(back[2])],
            shear: [_mm256_cvtss_f32(shear_x), _mm256_cvtss_f32(shear_y)],
            direction_z: _mm256_cvtss_f32(direction_z),
            t_min: ray.t_min,
            t_max: ray.t_max,
        };
        let limits = limits(_mm256_set1_ps(ray.t_min), _mm256_set1_ps(ray.t_max), direction_z);
        (frame, Frame { rows: axes.rows, back, shear: [shear_x, shear_y], direction_z, limits })
    }
}

/// [`RayFrame::depths`](crate::geom::RayFrame), all at once.
#[inline(always)]
fn limits(t_min: __m256, t_max: __m256, direction_z: __m256) -> Limits {
    // SAFETY: as in `Avx2`.
    unsafe {
        let a = _mm256_mul_ps(_mm256_max_ps(t_min, _mm256_set1_ps(f32::MIN)), direction_z);
        let b = _mm256_mul_ps(_mm256_min_ps(t_max, _mm256_set1_ps(f32::MAX)), direction_z);
        // The lower end twice, the upper end twice: an end's even lane is lowered, its odd one is raised.
        let ends = _mm256_blend_ps::<0b1100_1100>(_mm256_min_ps(a, b), _mm256_max_ps(a, b));
        let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), ends);
        let slack = _mm256_mul_ps(size, _mm256_set1_ps(Depths::SLACK));
        let ends = _mm256_addsub_ps(ends, _mm256_add_ps(slack, _mm256_set1_ps(f32::MIN_POSITIVE)));
        let [nearest, surely_from, surely_to] = spread_axes(ends);
        let farthest = _mm256_permute_ps::<0b11_11_11_11>(ends);
        let start = _mm256_blendv_ps(nearest, farthest, direction_z);
        let ahead = _mm256_and_ps(_mm256_set1_ps(-0.0), direction_z);
        Limits { nearest, farthest, surely_from, surely_to, start, ahead }
    }
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

/// What sifting asks of eight triangles.
#[derive(Clone, Copy)]
pub(super) struct Spans {
    points: [(__m256, __m256, __m256); 3],
    edges: [__m256; 3],
    /// The smallest and the largest of the edge functions.
    pub(super) least: __m256,
    pub(super) most: __m256,
    /// The smallest and the largest of the corners' depths.
    pub(super) first: __m256,
    pub(super) last: __m256,
}

impl Spans {
    /// The sum of the edge functions: no number if one of them is none, which the smallest and the largest don't tell.
    #[inline(always)]
    pub(super) fn sum(&self) -> __m256 {
        let [u, v, w] = self.edges;
        // SAFETY: as in `Avx2`.
        unsafe { _mm256_add_ps(_mm256_add_ps(u, v), w) }
    }

    /// Negative where a triangle whose corners lie on both sides of the start is surely crossed before it: the mean of the
    /// corners' depths, less the start and more than all roundings (docs/watertight.md, section 7). Elsewhere, if all lie behind the
    /// start, not negative, and not a number where something overflows.
    #[inline(always)]
    pub(super) fn before_start(&self, frame: &Frame) -> __m256 {
        let ([u, v, w], [p0, p1, p2], Limits { start, ahead, .. }) = (self.edges, self.points, frame.limits);
        // SAFETY: as in `Avx2`.
        unsafe {
            let mean = _mm256_mul_ps(u, _mm256_sub_ps(p0.2, start));
            let mean = _mm256_fmadd_ps(v, _mm256_sub_ps(p1.2, start), mean);
            let mean = _mm256_fmadd_ps(w, _mm256_sub_ps(p2.2, start), mean);
            let x = _mm256_fmadd_ps(p0.0, p0.0, _mm256_fmadd_ps(p1.0, p1.0, _mm256_mul_ps(p2.0, p2.0)));
            let y = _mm256_fmadd_ps(p0.1, p0.1, _mm256_fmadd_ps(p1.1, p1.1, _mm256_mul_ps(p2.1, p2.1)));
            // Doubled, so that it overflows before the mean does.
            let most =
                _mm256_fmadd_ps(_mm256_add_ps(x, y), _mm256_set1_ps(2.0), _mm256_set1_ps(4.0 * f32::MIN_POSITIVE));
            let most = _mm256_mul_ps(most, _mm256_sub_ps(self.last, self.first));
            let (roundings, least) = (_mm256_set1_ps(1.0 / (1 << 22) as f32), _mm256_set1_ps(f32::MIN_POSITIVE));
            let sum = _mm256_and_ps(_mm256_set1_ps(-0.0), _mm256_add_ps(self.least, self.most));
            let mean = _mm256_xor_ps(mean, _mm256_xor_ps(sum, ahead));
            _mm256_add_ps(mean, _mm256_fmadd_ps(most, roundings, least))
        }
    }
}

#[inline(always)]
pub(super) fn spans(frame: &Frame, block: &Block) -> Spans {
    let (p0, p1, p2) =
        (shear(frame, &block.corners[0]), shear(frame, &block.corners[1]), shear(frame, &block.corners[2]));
    let (u, v, w) = (cross(p2, p1), cross(p0, p2), cross(p1, p0));
    // SAFETY: as in `Avx2`.
    unsafe {
        Spans {
            points: [p0, p1, p2],
            edges: [u, v, w],
            least: _mm256_min_ps(_mm256_min_ps(u, v), w),
            most: _mm256_max_ps(_mm256_max_ps(u, v), w),
            first: _mm256_min_ps(_mm256_min_ps(p0.2, p1.2), p2.2),
            last: _mm256_max_ps(_mm256_max_ps(p0.2, p1.2), p2.2),
        }
    }
}

/// Eight corners in the ray's frame: sheared x and y, and depth.
#[inline(always)]
fn shear(frame: &Frame, corner: &[[f32; 8]; 3]) -> (__m256, __m256, __m256) {
    let ([x, y, z], p) = (frame.rows, corner.as_ptr().cast::<f32>());
    // SAFETY: as in `Avx2`; a corner has three rows of eight floats, and a frame's rows begin at 16 at most.
    unsafe {
        let z = _mm256_add_ps(frame.back[2], _mm256_loadu_ps(p.add(z)));
        let x = _mm256_add_ps(frame.back[0], _mm256_loadu_ps(p.add(x)));
        let y = _mm256_add_ps(frame.back[1], _mm256_loadu_ps(p.add(y)));
        (_mm256_sub_ps(x, _mm256_mul_ps(frame.shear[0], z)), _mm256_sub_ps(y, _mm256_mul_ps(frame.shear[1], z)), z)
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
