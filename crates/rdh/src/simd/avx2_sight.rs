//! What an eye sees, with AVX2: eight rays at once (`sight.rs` says what is computed).

use std::arch::x86_64::*;

use super::Sifted;
use super::sight::{self, Aims, Corners, Entry, Met, Octet, RAYS, Shade, Sight, Views};
use crate::geom::{Ray, Vec3};

// SAFETY, for every block below: these functions are called by `Avx2` and `Avx512` alone, whose callers have made sure of the
// instructions. Loads and stores lie within the references they are made from, and are unaligned ones but where the block says otherwise.

/// [`sight::in_view`].
#[inline(always)]
pub(super) fn in_view(entry: &Entry, views: &Views) -> u32 {
    // SAFETY: see above; each row has eight numbers.
    unsafe {
        let (low_u, low_v) = (_mm_set1_epi16(entry.low[0]), _mm_set1_epi16(entry.low[1]));
        let (high_u, high_v) = (_mm_set1_epi16(entry.high[0]), _mm_set1_epi16(entry.high[1]));
        let beside_u =
            _mm_or_si128(_mm_cmpgt_epi16(low_u, row(&views.high[0])), _mm_cmpgt_epi16(row(&views.low[0]), high_u));
        let beside_v =
            _mm_or_si128(_mm_cmpgt_epi16(low_v, row(&views.high[1])), _mm_cmpgt_epi16(row(&views.low[1]), high_v));
        let beside = _mm_packs_epi16(_mm_or_si128(beside_u, beside_v), _mm_setzero_si128());
        let behind = _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_set1_ps(entry.near), _mm256_loadu_ps(views.least.as_ptr()));
        !(_mm_movemask_epi8(beside) | _mm256_movemask_ps(behind)) as u32 & 0xff
    }
}

/// A row of views.
#[inline(always)]
fn row(row: &[i16; RAYS]) -> __m128i {
    // SAFETY: see above; a row has eight numbers.
    unsafe { _mm_loadu_si128(row.as_ptr().cast()) }
}

/// A linear form of eight places.
#[inline(always)]
fn form(f: &[f32; 3], u: __m256, v: __m256) -> __m256 {
    // SAFETY: see above.
    unsafe { _mm256_fmadd_ps(_mm256_set1_ps(f[0]), u, _mm256_fmadd_ps(_mm256_set1_ps(f[1]), v, _mm256_set1_ps(f[2]))) }
}

/// The least of a sight's edge functions.
#[inline(always)]
fn inside(sight: &Sight, u: __m256, v: __m256) -> __m256 {
    let [a, b, c] = &sight.edges;
    // SAFETY: see above.
    unsafe { _mm256_min_ps(_mm256_min_ps(form(a, u, v), form(b, u, v)), form(c, u, v)) }
}

/// The least and the largest nearness of hits.
#[inline(always)]
fn span(sight: &Sight, u: __m256, v: __m256) -> (__m256, __m256) {
    let nearness = form(&sight.nearness, u, v);
    // SAFETY: see above.
    unsafe {
        let slack = _mm256_fmadd_ps(nearness, _mm256_set1_ps(sight.slack[0]), _mm256_set1_ps(sight.slack[1]));
        (_mm256_sub_ps(nearness, slack), _mm256_add_ps(nearness, slack))
    }
}

/// [`sight::see`].
#[inline(always)]
pub(super) fn see(sight: &Sight, index: u32, octet: &mut Octet) -> bool {
    // SAFETY: see above; each row has eight numbers.
    unsafe {
        let (u, v) = (_mm256_loadu_ps(octet.u.as_ptr()), _mm256_loadu_ps(octet.v.as_ptr()));
        let inside = inside(sight, u, v);
        let maybe = _mm256_cmp_ps::<_CMP_GE_OQ>(inside, _mm256_set1_ps(-1.0));
        if _mm256_movemask_ps(maybe) == 0 {
            return false;
        }
        let (low, high) = span(sight, u, v);
        let (least, most) = (_mm256_loadu_ps(octet.least.as_ptr()), _mm256_loadu_ps(octet.most.as_ptr()));
        let index = _mm256_set1_epi32(index as i32);
        let mut same = _mm256_cmpeq_epi32(candidates(octet, 0), index);
        if octet.several != 0 {
            for row in 1..Octet::CANDIDATES {
                same = _mm256_or_si256(same, _mm256_cmpeq_epi32(candidates(octet, row), index));
            }
        }
        let maybe = _mm256_and_ps(maybe, _mm256_cmp_ps::<_CMP_GE_OQ>(high, least));
        let maybe = _mm256_andnot_ps(_mm256_castsi256_ps(same), maybe);
        let lanes = _mm256_movemask_ps(maybe);
        if lanes == 0 {
            return false;
        }
        let certain = _mm256_and_ps(maybe, _mm256_cmp_ps::<_CMP_GT_OQ>(inside, _mm256_set1_ps(1.0)));
        let wins = _mm256_and_ps(certain, _mm256_cmp_ps::<_CMP_GT_OQ>(low, most));
        let won = _mm256_movemask_ps(wins);
        put(octet, 0, index, wins);
        if octet.several & won as u32 != 0 {
            for row in 1..Octet::CANDIDATES {
                put(octet, row, _mm256_set1_epi32(Octet::NONE as i32), wins);
            }
            octet.several &= !(won as u32);
            octet.unsure &= !(won as u32);
        }
        let (mut takes, mut most) = (wins, _mm256_blendv_ps(most, high, wins));
        if won != lanes {
            let mut open = _mm256_andnot_ps(wins, maybe);
            most = _mm256_blendv_ps(most, _mm256_max_ps(most, high), open);
            takes = _mm256_or_ps(takes, _mm256_and_ps(certain, _mm256_cmp_ps::<_CMP_GT_OQ>(low, least)));
            for row in 0..Octet::CANDIDATES {
                let none = _mm256_cmpeq_epi32(candidates(octet, row), _mm256_set1_epi32(Octet::NONE as i32));
                let room = _mm256_and_ps(open, _mm256_castsi256_ps(none));
                put(octet, row, index, room);
                open = _mm256_andnot_ps(room, open);
                octet.several |= if row > 0 { _mm256_movemask_ps(room) as u32 } else { 0 };
            }
            octet.unsure |= _mm256_movemask_ps(open) as u32;
        }
        _mm256_storeu_ps(octet.least.as_mut_ptr(), _mm256_blendv_ps(least, low, takes));
        _mm256_storeu_ps(octet.most.as_mut_ptr(), most);
        true
    }
}

/// A row of candidates.
#[inline(always)]
fn candidates(octet: &Octet, row: usize) -> __m256i {
    // SAFETY: see above; a row has eight numbers.
    unsafe { _mm256_loadu_si256(octet.best[row].as_ptr().cast()) }
}

/// Puts a number into some lanes of a row of candidates.
#[inline(always)]
fn put(octet: &mut Octet, row: usize, index: __m256i, lanes: __m256) {
    let best = candidates(octet, row);
    // SAFETY: see above; a row has eight numbers.
    unsafe {
        let best = _mm256_blendv_ps(_mm256_castsi256_ps(best), _mm256_castsi256_ps(index), lanes);
        _mm256_storeu_si256(octet.best[row].as_mut_ptr().cast(), _mm256_castps_si256(best));
    }
}

/// [`sight::shade`].
#[inline(always)]
pub(super) fn shade(sight: &Sight, rays: &Shade) -> Sifted {
    // SAFETY: see above; each row has eight numbers.
    unsafe {
        let (u, v) = (_mm256_loadu_ps(rays.u.as_ptr()), _mm256_loadu_ps(rays.v.as_ptr()));
        let inside = inside(sight, u, v);
        let maybe = _mm256_cmp_ps::<_CMP_GE_OQ>(inside, _mm256_set1_ps(-1.0));
        if _mm256_movemask_ps(maybe) == 0 {
            return Sifted { possible: 0, certain: 0 };
        }
        let (low, high) = span(sight, u, v);
        let maybe = _mm256_and_ps(maybe, _mm256_cmp_ps::<_CMP_GT_OQ>(high, _mm256_loadu_ps(rays.far.as_ptr())));
        let certain = _mm256_and_ps(maybe, _mm256_cmp_ps::<_CMP_GT_OQ>(inside, _mm256_set1_ps(1.0)));
        let within = _mm256_and_ps(
            _mm256_cmp_ps::<_CMP_GT_OQ>(low, _mm256_loadu_ps(rays.far_surely.as_ptr())),
            _mm256_cmp_ps::<_CMP_LT_OQ>(high, _mm256_loadu_ps(rays.near_surely.as_ptr())),
        );
        let certain = _mm256_movemask_ps(_mm256_and_ps(certain, within)) as u32;
        Sifted { possible: _mm256_movemask_ps(maybe) as u32, certain }
    }
}

/// Rows of four numbers, column by column, but for the fourth: those of rows 0 to 3 in the lower half, of 4 to 7 in the upper.
///
/// # Safety
/// At each pointer there are four numbers.
#[inline(always)]
pub(super) unsafe fn columns(rows: [*const f32; RAYS]) -> [__m256; 4] {
    // SAFETY: see above.
    unsafe {
        let a = _mm256_loadu2_m128(rows[4], rows[0]);
        let b = _mm256_loadu2_m128(rows[5], rows[1]);
        let c = _mm256_loadu2_m128(rows[6], rows[2]);
        let d = _mm256_loadu2_m128(rows[7], rows[3]);
        let (low_ab, low_cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
        let (high_ab, high_cd) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0b01_00_01_00>(low_ab, low_cd),
            _mm256_shuffle_ps::<0b11_10_11_10>(low_ab, low_cd),
            _mm256_shuffle_ps::<0b01_00_01_00>(high_ab, high_cd),
            _mm256_shuffle_ps::<0b11_10_11_10>(high_ab, high_cd),
        ]
    }
}

/// [`sight::aim`].
#[inline(always)]
pub(super) fn aim(rays: &[&Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
    const { assert!(size_of::<Ray>() == 9 * size_of::<f32>(), "origin, direction, t_min, t_max, mask") }
    // SAFETY: see above; a ray is nine numbers: origin, direction, the interval and the mask. Four are read from the first, the fourth and
    // the sixth one on.
    unsafe {
        let origins = numbers(rays, 0);
        let eye4 = _mm_castps_si128(_mm_set_ps(0.0, eye[2], eye[1], eye[0]));
        let mut differs = _mm_setzero_si128();
        for origin in origins {
            let origin = _mm_castps_si128(_mm_loadu_ps(origin));
            differs = _mm_or_si128(differs, _mm_xor_si128(origin, eye4));
        }
        if _mm_movemask_epi8(_mm_cmpeq_epi32(differs, _mm_setzero_si128())) & 0xfff != 0xfff {
            return sight::aim(rays, eye, aims);
        }
        let [dx, dy, dz, t_min] = columns(numbers(rays, 3));
        let [_, _, t_max, _] = columns(numbers(rays, 5));
        let (zero, is) = (_mm256_setzero_ps(), longest(dx, dy, dz));
        let (first, second, along) = (pick(is, dy, dz, dx), pick(is, dz, dx, dy), pick(is, dx, dy, dz));
        let none =
            _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, zero), _mm256_mul_ps(dy, zero)), _mm256_mul_ps(dz, zero));
        let interval =
            _mm256_and_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(t_min, zero), _mm256_cmp_ps::<_CMP_LE_OQ>(t_min, t_max));
        let own = _mm256_and_ps(_mm256_and_ps(is_usual(along), interval), _mm256_cmp_ps::<_CMP_EQ_OQ>(none, zero));
        let side = side(is, _mm256_cmp_ps::<_CMP_LT_OQ>(along, zero), own);
        _mm256_storeu_ps(aims.shear[0].as_mut_ptr(), _mm256_div_ps(first, along));
        _mm256_storeu_ps(aims.shear[1].as_mut_ptr(), _mm256_div_ps(second, along));
        _mm256_storeu_ps(aims.direction_z.as_mut_ptr(), along);
        _mm256_storeu_ps(aims.t_min.as_mut_ptr(), t_min);
        _mm256_storeu_ps(aims.t_max.as_mut_ptr(), t_max);
        _mm256_storeu_ps(aims.side.as_mut_ptr().cast(), side);
    }
}

/// Without the sign.
#[inline(always)]
pub(super) fn size(x: __m256) -> __m256 {
    // SAFETY: see above.
    unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), x) }
}

/// Whether rays' longest axis is x, and whether it is y.
#[inline(always)]
pub(super) fn longest(dx: __m256, dy: __m256, dz: __m256) -> [__m256; 2] {
    let (x, y, z) = (size(dx), size(dy), size(dz));
    // SAFETY: see above.
    unsafe {
        let x_over_y = _mm256_cmp_ps::<_CMP_GT_OQ>(x, y);
        let is_x = _mm256_and_ps(x_over_y, _mm256_cmp_ps::<_CMP_GT_OQ>(x, z));
        [is_x, _mm256_andnot_ps(x_over_y, _mm256_cmp_ps::<_CMP_GT_OQ>(y, z))]
    }
}

/// Whether the longest components are neither too short nor too long.
#[inline(always)]
pub(super) fn is_usual(along: __m256) -> __m256 {
    let length = size(along);
    // SAFETY: see above.
    unsafe {
        _mm256_and_ps(
            _mm256_cmp_ps::<_CMP_GE_OQ>(length, _mm256_set1_ps(Aims::SHORTEST)),
            _mm256_cmp_ps::<_CMP_LE_OQ>(length, _mm256_set1_ps(Aims::LONGEST)),
        )
    }
}

/// The sides of rays that are the eye's: twice the axis, and 1 more where the second mask says so; all others are strays.
#[inline(always)]
pub(super) fn side(is: [__m256; 2], second: __m256, own: __m256) -> __m256 {
    // SAFETY: see above.
    unsafe {
        let axis = _mm256_castps_si256(pick(is, number(0), number(2), number(4)));
        let side = _mm256_castsi256_ps(_mm256_sub_epi32(axis, _mm256_castps_si256(second)));
        _mm256_blendv_ps(number(Aims::STRAY), side, own)
    }
}

/// Of x, y and z what belongs to a ray's longest axis.
#[inline(always)]
pub(super) fn pick([is_x, is_y]: [__m256; 2], x: __m256, y: __m256, z: __m256) -> __m256 {
    // SAFETY: see above.
    unsafe { _mm256_blendv_ps(_mm256_blendv_ps(z, y, is_y), x, is_x) }
}

/// The bits of a number in all lanes.
#[inline(always)]
fn number(x: u32) -> __m256 {
    // SAFETY: see above.
    unsafe { _mm256_castsi256_ps(_mm256_set1_epi32(x as i32)) }
}

/// Where eight triangles' corners lie.
#[inline(always)]
fn corner(corners: &[&Corners; RAYS], c: usize) -> [*const f32; RAYS] {
    let mut rows = [std::ptr::null(); RAYS];
    for (row, corners) in rows.iter_mut().zip(corners) {
        *row = corners[c].as_ptr();
    }
    rows
}

/// Where eight rays' numbers lie, from one on.
#[inline(always)]
pub(super) fn numbers(rays: &[&Ray; RAYS], first: usize) -> [*const f32; RAYS] {
    let mut rows = [std::ptr::null(); RAYS];
    for (row, ray) in rows.iter_mut().zip(rays) {
        *row = std::ptr::from_ref(*ray).cast::<f32>().wrapping_add(first);
    }
    rows
}

/// The cross product of two points.
#[inline(always)]
fn cross(ax: __m256d, ay: __m256d, bx: __m256d, by: __m256d) -> __m256d {
    // SAFETY: see above.
    unsafe { _mm256_sub_pd(_mm256_mul_pd(ax, by), _mm256_mul_pd(ay, bx)) }
}

/// Sheared corners of eight triangles.
type Sheared = [[__m256; 3]; 3];

/// [`sight::meet_own`].
#[inline(always)]
pub(super) fn meet_own(aims: &Aims, eye: &Vec3, corners: &[&Corners; RAYS], met: &mut Met) {
    // SAFETY: see above; three times four numbers a triangle.
    unsafe {
        let (shear_x, shear_y) = (_mm256_loadu_ps(aims.shear[0].as_ptr()), _mm256_loadu_ps(aims.shear[1].as_ptr()));
        let [ox, oy, oz] = [_mm256_set1_ps(eye[0]), _mm256_set1_ps(eye[1]), _mm256_set1_ps(eye[2])];
        let mut p: Sheared = [[_mm256_setzero_ps(); 3]; 3];
        for (c, p) in p.iter_mut().enumerate() {
            let [x, y, z, _] = columns(corner(corners, c));
            // As THE triangle test: products and differences apart.
            let z = _mm256_sub_ps(z, oz);
            let x = _mm256_sub_ps(_mm256_sub_ps(x, ox), _mm256_mul_ps(shear_x, z));
            let y = _mm256_sub_ps(_mm256_sub_ps(y, oy), _mm256_mul_ps(shear_y, z));
            *p = [x, y, z];
        }
        let direction_z = _mm256_loadu_ps(aims.direction_z.as_ptr());
        let (t_low, u_low, v_low, in_low) = half::<0>(&p, direction_z);
        let (t_high, u_high, v_high, in_high) = half::<1>(&p, direction_z);
        let t = _mm256_set_m128(t_high, t_low);
        let (t_min, t_max) = (_mm256_loadu_ps(aims.t_min.as_ptr()), _mm256_loadu_ps(aims.t_max.as_ptr()));
        let finite =
            _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_andnot_ps(_mm256_set1_ps(-0.0), t), _mm256_set1_ps(f32::INFINITY));
        let within = _mm256_and_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(t, t_min), _mm256_cmp_ps::<_CMP_LE_OQ>(t, t_max));
        met.hits = _mm256_movemask_ps(_mm256_and_ps(finite, within)) as u32 & (in_low | in_high << 4);
        _mm256_storeu_ps(met.t.as_mut_ptr(), t);
        _mm256_storeu_ps(met.u.as_mut_ptr(), _mm256_set_m128(u_high, u_low));
        _mm256_storeu_ps(met.v.as_mut_ptr(), _mm256_set_m128(v_high, v_low));
    }
}

/// Four of eight numbers, in f64.
#[inline(always)]
pub(super) fn wide<const HALF: i32>(x: __m256) -> __m256d {
    // SAFETY: see above.
    unsafe { _mm256_cvtps_pd(_mm256_extractf128_ps::<HALF>(x)) }
}

/// `t`, `u`, `v` of four rays, and which of them cross their triangles.
#[inline(always)]
fn half<const HALF: i32>(p: &Sheared, direction_z: __m256) -> (__m128, __m128, __m128, u32) {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = p;
    let (ax, ay, az) = (wide::<HALF>(*ax), wide::<HALF>(*ay), wide::<HALF>(*az));
    let (bx, by, bz) = (wide::<HALF>(*bx), wide::<HALF>(*by), wide::<HALF>(*bz));
    let (cx, cy, cz) = (wide::<HALF>(*cx), wide::<HALF>(*cy), wide::<HALF>(*cz));
    // SAFETY: see above.
    unsafe {
        let (u, v, w) = (cross(cx, cy, bx, by), cross(ax, ay, cx, cy), cross(bx, by, ax, ay));
        let zero = _mm256_setzero_pd();
        let below = _mm256_or_pd(
            _mm256_or_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(u, zero), _mm256_cmp_pd::<_CMP_LT_OQ>(v, zero)),
            _mm256_cmp_pd::<_CMP_LT_OQ>(w, zero),
        );
        let above = _mm256_or_pd(
            _mm256_or_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(u, zero), _mm256_cmp_pd::<_CMP_GT_OQ>(v, zero)),
            _mm256_cmp_pd::<_CMP_GT_OQ>(w, zero),
        );
        let sum = _mm256_add_pd(_mm256_add_pd(u, v), w);
        let misses = _mm256_or_pd(_mm256_and_pd(below, above), _mm256_cmp_pd::<_CMP_EQ_OQ>(sum, zero));
        let depth = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(u, az), _mm256_mul_pd(v, bz)), _mm256_mul_pd(w, cz));
        let t = _mm256_div_pd(depth, _mm256_mul_pd(sum, wide::<HALF>(direction_z)));
        let t = _mm_add_ps(_mm256_cvtpd_ps(t), _mm_setzero_ps());
        let (u, v) = (_mm256_cvtpd_ps(_mm256_div_pd(v, sum)), _mm256_cvtpd_ps(_mm256_div_pd(w, sum)));
        (t, u, v, !(_mm256_movemask_pd(misses) as u32) & 0xf)
    }
}
