//! Rays that end at an eye, with AVX2: eight at once (`approach.rs` says what is computed), in f64 by halves.

use std::arch::x86_64::*;

use super::Passing;
use super::approach::{LESS, MORE};
use super::avx2_sight::{columns, is_usual, longest, numbers, pick, side, size, wide};
use super::sight::{RAYS, Shade};
use crate::geom::Ray;

// SAFETY, for every block below: as in `avx2_sight.rs`.

/// Rays along the axes of their frames: the origin and the eye, the shear, the direction's z, the interval.
struct Along {
    origin: [__m256; 3],
    eye: [__m256; 3],
    shear: [__m256; 2],
    direction_z: __m256,
    t_min: __m256,
    t_max: __m256,
}

/// [`super::approach::approach`].
#[inline(always)]
pub(super) fn approach(rays: &[Ray; RAYS], passing: &Passing, shade: &mut Shade) -> [u32; RAYS] {
    const { assert!(size_of::<Ray>() == 9 * size_of::<f32>(), "origin, direction, t_min, t_max, mask") }
    // SAFETY: see above; a ray is nine numbers: origin, direction, the interval and the mask. Four are read from the first and from the
    // fifth one on.
    unsafe {
        let [ox, oy, oz, dx] = columns(numbers(&rays.each_ref(), 0));
        let [dy, dz, t_min, t_max] = columns(numbers(&rays.each_ref(), 4));
        let is = longest(dx, dy, dz);
        let [ex, ey, ez] = passing.eye;
        let (ex, ey, ez) = (_mm256_set1_ps(ex), _mm256_set1_ps(ey), _mm256_set1_ps(ez));
        let direction_z = pick(is, dx, dy, dz);
        let (first, second) = (pick(is, dy, dz, dx), pick(is, dz, dx, dy));
        let along = Along {
            origin: [pick(is, oy, oz, ox), pick(is, oz, ox, oy), pick(is, ox, oy, oz)],
            eye: [pick(is, ey, ez, ex), pick(is, ez, ex, ey), pick(is, ex, ey, ez)],
            shear: [_mm256_div_ps(first, direction_z), _mm256_div_ps(second, direction_z)],
            direction_z,
            t_min,
            t_max,
        };
        let (low, high) = (half::<0>(&along, passing), half::<1>(&along, passing));
        let farthest = _mm256_max_ps(_mm256_max_ps(size(ox), size(oy)), size(oz));
        // What is no number elsewhere makes `across` none.
        let nearby = _mm256_cmp_ps::<_CMP_LE_OQ>(farthest, _mm256_set1_ps(passing.reach));
        let own =
            _mm256_and_ps(_mm256_and_ps(is_usual(direction_z), nearby), _mm256_cmp_ps::<_CMP_LE_OQ>(t_min, t_max));
        let own = _mm256_and_ps(own, _mm256_set_m128(high.passes, low.passes));
        let mut sides = [0; RAYS];
        let up = _mm256_cmp_ps::<_CMP_GE_OQ>(direction_z, _mm256_setzero_ps());
        _mm256_storeu_ps(sides.as_mut_ptr().cast(), side(is, up, own));
        put(&mut shade.far, (low.far, high.far), f32::INFINITY, own);
        put(&mut shade.far_surely, (low.far_surely, high.far_surely), f32::INFINITY, own);
        put(&mut shade.near_surely, (low.near_surely, high.near_surely), f32::NEG_INFINITY, own);
        _mm256_storeu_ps(shade.u.as_mut_ptr(), _mm256_and_ps(along.shear[0], own));
        _mm256_storeu_ps(shade.v.as_mut_ptr(), _mm256_and_ps(along.shear[1], own));
        sides
    }
}

/// Writes eight numbers, or one in the place of those that are not the eye's.
#[inline(always)]
fn put(row: &mut [f32; RAYS], (low, high): (__m128, __m128), done: f32, own: __m256) {
    // SAFETY: see above; a row has eight numbers.
    unsafe {
        let numbers = _mm256_blendv_ps(_mm256_set1_ps(done), _mm256_set_m128(high, low), own);
        _mm256_storeu_ps(row.as_mut_ptr(), numbers);
    }
}

/// What is told of four rays.
struct Half {
    far: __m128,
    far_surely: __m128,
    near_surely: __m128,
    /// All ones where they pass by the eye closely, end there or before, and start before that.
    passes: __m128,
}

/// The exact difference of four of eight numbers.
#[inline(always)]
fn difference<const HALF: i32>(x: __m256, y: __m256) -> __m256d {
    // SAFETY: see above.
    unsafe { _mm256_sub_pd(wide::<HALF>(x), wide::<HALF>(y)) }
}

/// Whether a number is at most so large.
#[inline(always)]
fn within(x: __m256d, most: f64) -> __m256d {
    // SAFETY: see above.
    unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(_mm256_andnot_pd(_mm256_set1_pd(-0.0), x), _mm256_set1_pd(most)) }
}

/// The operations of [`Passing::approach`], in their order.
#[inline(always)]
fn half<const HALF: i32>(rays: &Along, passing: &Passing) -> Half {
    let ([ox, oy, oz], [ex, ey, ez], [sx, sy]) = (rays.origin, rays.eye, rays.shear);
    let (x, y, z) = (difference::<HALF>(ox, ex), difference::<HALF>(oy, ey), difference::<HALF>(oz, ez));
    // SAFETY: see above.
    unsafe {
        let across_x = _mm256_sub_pd(x, _mm256_mul_pd(wide::<HALF>(sx), z));
        let across_y = _mm256_sub_pd(y, _mm256_mul_pd(wide::<HALF>(sy), z));
        let closely = _mm256_and_pd(within(across_x, passing.slack), within(across_y, passing.slack));
        let (sign, direction_z) = (_mm256_set1_pd(-0.0), wide::<HALF>(rays.direction_z));
        // Turned where the direction is positive.
        let depth = _mm256_xor_pd(z, _mm256_andnot_pd(direction_z, sign));
        let length = _mm256_andnot_pd(sign, direction_z);
        let far = _mm256_sub_pd(depth, _mm256_mul_pd(wide::<HALF>(rays.t_min), length));
        let near = _mm256_sub_pd(depth, _mm256_mul_pd(wide::<HALF>(rays.t_max), length));
        let slack = _mm256_set1_pd(4.0 * passing.slack);
        let ends = _mm256_cmp_pd::<_CMP_GE_OQ>(near, _mm256_set1_pd(-2.0 * passing.slack));
        let starts = _mm256_cmp_pd::<_CMP_GT_OQ>(far, slack);
        let passes = _mm256_castpd_ps(_mm256_and_pd(closely, _mm256_and_pd(ends, starts)));
        let (less, more) = (_mm256_set1_pd(LESS), _mm256_set1_pd(MORE));
        Half {
            far: _mm256_cvtpd_ps(_mm256_div_pd(less, _mm256_add_pd(far, slack))),
            far_surely: _mm256_cvtpd_ps(_mm256_div_pd(more, _mm256_sub_pd(far, slack))),
            near_surely: _mm256_cvtpd_ps(_mm256_div_pd(less, _mm256_add_pd(near, slack))),
            passes: _mm_shuffle_ps::<0b10_00_10_00>(_mm256_castps256_ps128(passes), _mm256_extractf128_ps::<1>(passes)),
        }
    }
}
