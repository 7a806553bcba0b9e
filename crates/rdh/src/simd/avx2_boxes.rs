//! Rays against boxes with AVX2 and FMA: what a ray is made ready for, and the tests of two, four and eight boxes at once.
//!
//! "As in `Avx2`": these functions run only within the kernels, where the CPU has the instructions (`avx2.rs`).

use std::arch::x86_64::*;

use super::avx2::{load_twice, spread_axes};
use super::{BoxRay, Boxes, Entered};
use crate::geom::{PlaneFrame, Ray, Scale};

/// A [`BoxRay`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct WideRay {
    inverse: [__m256; 3],
    enters: [__m256; 3],
    leaves: [__m256; 3],
    t_min: __m256,
    end: __m256,
    /// Where in a node of eight the rows of planes begin that are met first.
    near: [usize; 3],
    t_scale: f64,
}

/// The rows of planes met first, by the directions a ray runs: a bit an axis, 1 for down.
static NEAR: [[usize; 3]; 8] = {
    let mut near = [[0; 3]; 8];
    let mut i = 0;
    while i < 24 {
        let (down, axis) = (i / 3, i % 3);
        near[down][axis] = ((down >> axis & 1) * 3 + axis) * 8;
        i += 1;
    }
    near
};

impl WideRay {
    /// [`BoxRay::new`]; nothing if the ray is invalid.
    #[inline(always)]
    pub(super) fn of(ray: &Ray, scale: Scale, magnitude: f32) -> Option<Self> {
        let axes = match usual(ray, scale, magnitude) {
            Some(axes) => axes,
            None => unusual(ray, scale, magnitude)?,
        };
        Some(Self::new(&axes))
    }

    /// Where it ends.
    #[inline(always)]
    pub(super) fn end(&self) -> f32 {
        // SAFETY: as in `Avx2`.
        unsafe { _mm256_cvtss_f32(self.end) }
    }

    /// Ends it at a hit, given in the ray's own `t`.
    #[inline(always)]
    pub(super) fn end_at(&mut self, t: f32) {
        // SAFETY: as in `Avx2`.
        self.end = unsafe { _mm256_set1_ps(BoxRay::end_for(t, self.t_scale)) };
    }

    #[inline(always)]
    fn new(ray: &AxesRay) -> Self {
        // SAFETY: as in `Avx2`.
        unsafe {
            Self {
                inverse: spread_axes(ray.inverse),
                enters: spread_axes(ray.enters),
                leaves: spread_axes(ray.leaves),
                t_min: _mm256_set1_ps(ray.t_min),
                end: _mm256_set1_ps(ray.end),
                near: NEAR[ray.down & 7],
                t_scale: ray.t_scale,
            }
        }
    }
}

/// A [`BoxRay`] whose axes lie in the first three lanes of both halves.
#[derive(Clone, Copy)]
struct AxesRay {
    inverse: __m256,
    enters: __m256,
    leaves: __m256,
    t_min: f32,
    end: f32,
    t_scale: f64,
    down: usize,
}

/// The largest sizes of an origin's and a direction's components with which a ray needs no special care …
const MOST: [[f32; 4]; 2] = {
    let (far, long) = (PlaneFrame::FAR.next_down(), PlaneFrame::LONG);
    [[far, far, far, long], [long, long, long, f32::INFINITY]]
};
/// … and the smallest ones of a direction's, of which one has to be reached.
const LEAST: [f32; 4] = {
    let (never, short) = (f32::NAN, PlaneFrame::SHORT);
    [short, short, short, never]
};

/// [`BoxRay::new`] for nearly all rays: valid, and with nothing to be scaled.
#[inline(always)]
fn usual(ray: &Ray, scale: Scale, magnitude: f32) -> Option<AxesRay> {
    // SAFETY: as in `Avx2`; a ray begins with seven floats, in this order: origin, direction and `t_min`.
    unsafe {
        let p = std::ptr::from_ref(ray).cast::<f32>();
        // Twice in a register, so that the axes can be spread by the fast shuffles, which stay within halves.
        let (origin, direction) = (load_twice(p), load_twice(p.add(3)));
        let sign = _mm256_set1_ps(-0.0);
        let (from, along) = (_mm256_andnot_ps(sign, origin), _mm256_andnot_ps(sign, direction));
        // What is not a number compares as false.
        let near = _mm256_cmp_ps::<_CMP_LE_OQ>(from, load_twice(MOST[0].as_ptr()));
        let short = _mm256_cmp_ps::<_CMP_LE_OQ>(along, load_twice(MOST[1].as_ptr()));
        let moves = _mm256_cmp_ps::<_CMP_GE_OQ>(along, load_twice(LEAST.as_ptr()));
        let is_usual = _mm256_movemask_ps(_mm256_and_ps(near, short)) == 0xff
            && _mm256_movemask_ps(moves) != 0
            && ray.t_min <= ray.t_max
            && scale.factor() == 1.0;
        if !is_usual {
            return None;
        }
        let (from_y, from_z) =
            (_mm256_shuffle_ps::<0b00_00_10_01>(from, from), _mm256_shuffle_ps::<0b00_01_00_10>(from, from));
        let reach = _mm256_max_ps(_mm256_max_ps(from, from_y), from_z);
        let slack =
            _mm256_mul_ps(_mm256_add_ps(reach, _mm256_set1_ps(magnitude)), _mm256_set1_ps(1.0 / (1 << 21) as f32));
        let signs = _mm256_and_ps(sign, direction);
        let slack = _mm256_or_ps(slack, signs);
        // Sizes compare like integers, which is faster.
        let parallel = _mm256_castps_si256(_mm256_set1_ps(PlaneFrame::PARALLEL));
        let along = _mm256_castsi256_ps(_mm256_max_epu32(_mm256_castps_si256(along), parallel));
        let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_or_ps(along, signs));
        let back = _mm256_xor_ps(sign, origin);
        let enters = _mm256_mul_ps(_mm256_sub_ps(back, slack), inverse);
        let leaves = _mm256_mul_ps(_mm256_add_ps(back, slack), inverse);
        let down = _mm256_movemask_ps(direction) as usize;
        Some(AxesRay { inverse, enters, leaves, t_min: ray.t_min, end: ray.t_max, t_scale: 1.0, down })
    }
}

/// [`BoxRay::new`] for all others.
#[inline(always)]
fn unusual(ray: &Ray, scale: Scale, magnitude: f32) -> Option<AxesRay> {
    #[cold]
    #[inline(never)]
    fn prepare(ray: &Ray, scale: Scale, magnitude: f32) -> Option<BoxRay> {
        BoxRay::new(ray, scale, magnitude)
    }
    let ray = prepare(ray, scale, magnitude)?;
    let (inverse, enters, leaves) = (twice(ray.inverse), twice(ray.enters), twice(ray.leaves));
    let BoxRay { t_min, end, t_scale, .. } = ray;
    Some(AxesRay { inverse, enters, leaves, t_min, end, t_scale, down: ray.down() })
}

#[inline(always)]
fn twice([x, y, z]: [f32; 3]) -> __m256 {
    // SAFETY: as in `Avx2`.
    unsafe { _mm256_setr_ps(x, y, z, 0.0, x, y, z, 0.0) }
}

/// Where the ray enters and leaves eight boxes.
///
/// # Safety
/// As in `Avx2`; `W` must be 8.
#[inline(always)]
pub(super) unsafe fn enter_and_leave<const W: usize>(ray: &WideRay, boxes: &Boxes<W>) -> (__m256, __m256) {
    let p = boxes.planes.as_ptr().cast::<f32>();
    let [nx, ny, nz] = ray.near;
    let (fx, fy, fz) = (3 * 8 - nx, 5 * 8 - ny, 7 * 8 - nz);
    // SAFETY: every offset is that of one of the six rows of `W` planes, as `NEAR` says.
    unsafe {
        let near_x = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(nx)), ray.inverse[0], ray.enters[0]);
        let near_y = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(ny)), ray.inverse[1], ray.enters[1]);
        let near_z = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(nz)), ray.inverse[2], ray.enters[2]);
        let far_x = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(fx)), ray.inverse[0], ray.leaves[0]);
        let far_y = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(fy)), ray.inverse[1], ray.leaves[1]);
        let far_z = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(fz)), ray.inverse[2], ray.leaves[2]);
        let near = _mm256_max_ps(_mm256_max_ps(near_x, near_y), _mm256_max_ps(near_z, ray.t_min));
        let far = _mm256_min_ps(_mm256_min_ps(far_x, far_y), _mm256_min_ps(far_z, ray.end));
        (near, far)
    }
}

/// Where the ray enters and leaves two or four boxes.
///
/// # Safety
/// As in `Avx2`; `W` must be 2 or 4.
#[inline(always)]
pub(super) unsafe fn enter_and_leave_few<const W: usize>(ray: &WideRay, boxes: &Boxes<W>) -> (__m128, __m128) {
    let p = boxes.planes.as_ptr().cast::<f32>();
    // SAFETY: every offset is that of one of the six rows of `W` planes, as `NEAR` says.
    unsafe {
        let (mut near, mut far) = (_mm256_castps256_ps128(ray.t_min), _mm256_castps256_ps128(ray.end));
        for a in 0..3 {
            let first = load_few::<W>(p.add(ray.near[a] / 8 * W));
            let last = load_few::<W>(p.add((3 + 2 * a - ray.near[a] / 8) * W));
            let inverse = _mm256_castps256_ps128(ray.inverse[a]);
            near = _mm_max_ps(_mm_fmadd_ps(first, inverse, _mm256_castps256_ps128(ray.enters[a])), near);
            far = _mm_min_ps(_mm_fmadd_ps(last, inverse, _mm256_castps256_ps128(ray.leaves[a])), far);
        }
        (near, far)
    }
}

/// # Safety
/// As in `Avx2`; at `p` there are `W` floats, 2 or 4.
#[inline(always)]
unsafe fn load_few<const W: usize>(p: *const f32) -> __m128 {
    // SAFETY: see above.
    unsafe { if W == 2 { _mm_castpd_ps(_mm_load_sd(p.cast())) } else { _mm_loadu_ps(p) } }
}

/// # Safety
/// As in `Avx2`; `W` must be 2 or 4.
#[inline(always)]
pub(super) unsafe fn store_few<const W: usize>(t: &mut Entered<W>, v: __m128) {
    let p = t.0.as_mut_ptr();
    // SAFETY: see above; `t` has `W` floats.
    unsafe { if W == 2 { _mm_store_sd(p.cast(), _mm_castps_pd(v)) } else { _mm_storeu_ps(p, v) } }
}
