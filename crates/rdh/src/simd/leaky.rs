//! A ray as it would be cast if nothing had to be watertight: box planes without slack, and triangles by Möller and Trumbore (1997) in
//! f32, eight at a time, with edges that were prepared. For [`Twin`](crate::twin::Twin) alone.

use std::arch::x86_64::*;

use super::{Block, Boxes, Entered, LANES};
use crate::geom::{GeomId, Hit, InstId, Ray, TriId};

/// A ray in registers. With `MASKS` comparisons give masks, as AVX-512 can.
#[derive(Clone, Copy)]
pub(crate) struct LeakyRay<'a, const MASKS: bool> {
    inverse: [__m256; 3],
    /// Minus the origin, times the inverse.
    start: [__m256; 3],
    /// Where the rows of planes begin that are met first.
    near: [usize; 3],
    origin: [__m256; 3],
    direction: [__m256; 3],
    t_min: __m256,
    end: __m256,
    /// The triangles' masks, if they have any, and the ray's.
    masks: Option<&'a [u32]>,
    mask: u32,
    pub(crate) hit: Option<Hit>,
}

// SAFETY, for every block below: a `LeakyRay` is only used inside of jobs that run with AVX2 and FMA, and with AVX-512 VL if `MASKS`
// (`Twin` sees to it); loads and stores lie within the references they are made from, and are unaligned ones but where the block says
// otherwise.
impl<'a, const MASKS: bool> LeakyRay<'a, MASKS> {
    /// Prepares a ray; its direction must be finite.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, masks: Option<&'a [u32]>) -> Self {
        // SAFETY: see above; a ray begins with seven floats: origin, direction and `t_min`.
        unsafe {
            let p = std::ptr::from_ref(ray).cast::<f32>();
            let (origin, direction) = (twice(p), twice(p.add(3)));
            let sign = _mm256_set1_ps(-0.0);
            // Zeros are kept away from the division.
            let size = _mm256_max_ps(_mm256_andnot_ps(sign, direction), _mm256_set1_ps(f32::MIN_POSITIVE));
            let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_or_ps(size, _mm256_and_ps(sign, direction)));
            let start = _mm256_mul_ps(_mm256_xor_ps(sign, origin), inverse);
            let down = _mm256_movemask_ps(direction) as usize;
            Self {
                inverse: axes(inverse),
                start: axes(start),
                near: [24 * (down & 1), 8 + 24 * (down >> 1 & 1), 16 + 24 * (down >> 2 & 1)],
                origin: axes(origin),
                direction: axes(direction),
                t_min: _mm256_set1_ps(ray.t_min),
                end: _mm256_set1_ps(ray.t_max),
                masks,
                mask: ray.mask,
                hit: None,
            }
        }
    }

    /// Where it ends.
    #[inline(always)]
    pub(crate) fn end(&self) -> f32 {
        // SAFETY: see above.
        unsafe { _mm256_cvtss_f32(self.end) }
    }

    /// Ends it at a hit.
    #[inline(always)]
    pub(crate) fn end_at(&mut self, t: f32) {
        // SAFETY: see above.
        self.end = unsafe { _mm256_set1_ps(t) };
    }

    /// Which boxes it meets.
    #[inline(always)]
    pub(crate) fn meet(&self, boxes: &Boxes<8>, t: &mut Entered<8>) -> u32 {
        let p = boxes.planes.as_ptr().cast::<f32>();
        let [nx, ny, nz] = self.near;
        let (fx, fy, fz) = (24 - nx, 40 - ny, 56 - nz);
        let (inverse, start) = (&self.inverse, &self.start);
        // SAFETY: see above; every offset is that of one of the six rows of eight planes. `t` is aligned to 32 bytes.
        unsafe {
            let near_x = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(nx)), inverse[0], start[0]);
            let near_y = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(ny)), inverse[1], start[1]);
            let near_z = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(nz)), inverse[2], start[2]);
            let far_x = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(fx)), inverse[0], start[0]);
            let far_y = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(fy)), inverse[1], start[1]);
            let far_z = _mm256_fmadd_ps(_mm256_loadu_ps(p.add(fz)), inverse[2], start[2]);
            let near = _mm256_max_ps(_mm256_max_ps(near_x, near_y), _mm256_max_ps(near_z, self.t_min));
            let far = _mm256_min_ps(_mm256_min_ps(far_x, far_y), _mm256_min_ps(far_z, self.end));
            _mm256_store_ps(t.0.as_mut_ptr(), near);
            if MASKS {
                u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(near, far))
            } else {
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32
            }
        }
    }

    /// Tests the `wanted` triangles of a block of corners and edges; whether the ray goes on.
    #[inline(always)]
    pub(crate) fn test<const ANY: bool>(&mut self, block: &Block, wanted: u32) -> bool {
        let (corner, first, second) = (rows(&block.corners[0]), rows(&block.corners[1]), rows(&block.corners[2]));
        let across = cross(&self.direction, &second);
        let determinant = dot(&first, &across);
        let from = minus(&self.origin, &corner);
        let along = cross(&from, &first);
        // SAFETY: see above; arrays of eight floats are aligned to 32 bytes.
        unsafe {
            let sign = _mm256_and_ps(determinant, _mm256_set1_ps(-0.0));
            let size = _mm256_xor_ps(determinant, sign);
            let u = _mm256_xor_ps(dot(&from, &across), sign);
            let v = _mm256_xor_ps(dot(&self.direction, &along), sign);
            let t = _mm256_xor_ps(dot(&second, &along), sign);
            let (least, most) = (_mm256_mul_ps(size, self.t_min), _mm256_mul_ps(size, self.end));
            let mut found = inside::<MASKS>(u, v, size, (t, least, most)) & wanted;
            if let Some(masks) = self.masks
                && found != 0
            {
                found = seen(masks, self.mask, block.ids, found);
            }
            if found == 0 {
                return true;
            }
            if ANY {
                let nothing = Hit { t: 0.0, u: 0.0, v: 0.0, tri: TriId(0), geometry: GeomId(0), instance: InstId(0) };
                self.hit = Some(nothing);
                return false;
            }
            let scale = _mm256_div_ps(_mm256_set1_ps(1.0), size);
            let mut lanes = Found([[0.0; LANES]; 3]);
            for (row, x) in lanes.0.iter_mut().zip([t, u, v]) {
                _mm256_store_ps(row.as_mut_ptr(), _mm256_mul_ps(x, scale));
            }
            let [t, u, v] = &lanes.0;
            let mut best = found.trailing_zeros() as usize & (LANES - 1);
            found &= found - 1;
            while found != 0 {
                let lane = found.trailing_zeros() as usize & (LANES - 1);
                found &= found - 1;
                best = if t[lane] < t[best] { lane } else { best };
            }
            let tri = TriId(block.ids[best]);
            self.hit = Some(Hit { t: t[best], u: u[best], v: v[best], tri, geometry: GeomId(0), instance: InstId(0) });
            self.end_at(t[best]);
        }
        true
    }
}

/// Which of these lanes hold triangles that a ray sees. The ray itself stays in registers.
#[cold]
#[inline(never)]
fn seen(masks: &[u32], mask: u32, ids: [u32; LANES], lanes: u32) -> u32 {
    let sees = |lane: &usize| masks[ids[*lane] as usize] & mask != 0;
    (0..LANES).filter(sees).fold(0, |seen, lane| seen | 1 << lane) & lanes
}

/// `t`, `u` and `v` of eight triangles.
#[repr(C, align(32))]
struct Found([[f32; LANES]; 3]);

/// In which lanes a triangle is hit.
#[inline(always)]
fn inside<const MASKS: bool>(u: __m256, v: __m256, size: __m256, (t, least, most): (__m256, __m256, __m256)) -> u32 {
    // SAFETY: as in `LeakyRay`.
    unsafe {
        let (zero, sum) = (_mm256_setzero_ps(), _mm256_add_ps(u, v));
        if MASKS {
            let mask = _mm256_cmp_ps_mask::<_CMP_GE_OQ>(u, zero);
            let mask = _mm256_mask_cmp_ps_mask::<_CMP_GE_OQ>(mask, v, zero);
            let mask = _mm256_mask_cmp_ps_mask::<_CMP_LE_OQ>(mask, sum, size);
            let mask = _mm256_mask_cmp_ps_mask::<_CMP_GE_OQ>(mask, t, least);
            let mask = _mm256_mask_cmp_ps_mask::<_CMP_LE_OQ>(mask, t, most);
            u32::from(_mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(mask, size, zero))
        } else {
            let weights = _mm256_cmp_ps::<_CMP_GE_OQ>(_mm256_min_ps(u, v), zero);
            let weights = _mm256_and_ps(weights, _mm256_cmp_ps::<_CMP_LE_OQ>(sum, size));
            let within = _mm256_cmp_ps::<_CMP_GE_OQ>(t, least);
            let within = _mm256_and_ps(within, _mm256_cmp_ps::<_CMP_LE_OQ>(t, most));
            let within = _mm256_and_ps(within, _mm256_cmp_ps::<_CMP_GT_OQ>(size, zero));
            _mm256_movemask_ps(_mm256_and_ps(weights, within)) as u32
        }
    }
}

/// Four floats, in both halves of a register.
///
/// # Safety
/// As in `LeakyRay`; at `p` there are four floats.
#[inline(always)]
unsafe fn twice(p: *const f32) -> __m256 {
    // SAFETY: see above.
    unsafe { super::avx2::load_twice(p) }
}

#[inline(always)]
fn axes(v: __m256) -> [__m256; 3] {
    super::avx2::spread_axes(v)
}

#[inline(always)]
fn rows(corner: &[[f32; LANES]; 3]) -> [__m256; 3] {
    // SAFETY: as in `LeakyRay`; each row has eight floats.
    unsafe {
        [_mm256_loadu_ps(corner[0].as_ptr()), _mm256_loadu_ps(corner[1].as_ptr()), _mm256_loadu_ps(corner[2].as_ptr())]
    }
}

#[inline(always)]
fn minus(a: &[__m256; 3], b: &[__m256; 3]) -> [__m256; 3] {
    // SAFETY: as in `LeakyRay`.
    unsafe { [_mm256_sub_ps(a[0], b[0]), _mm256_sub_ps(a[1], b[1]), _mm256_sub_ps(a[2], b[2])] }
}

#[inline(always)]
fn cross(a: &[__m256; 3], b: &[__m256; 3]) -> [__m256; 3] {
    // SAFETY: as in `LeakyRay`.
    unsafe {
        [
            _mm256_fmsub_ps(a[1], b[2], _mm256_mul_ps(a[2], b[1])),
            _mm256_fmsub_ps(a[2], b[0], _mm256_mul_ps(a[0], b[2])),
            _mm256_fmsub_ps(a[0], b[1], _mm256_mul_ps(a[1], b[0])),
        ]
    }
}

#[inline(always)]
fn dot(a: &[__m256; 3], b: &[__m256; 3]) -> __m256 {
    // SAFETY: as in `LeakyRay`.
    unsafe { _mm256_fmadd_ps(a[0], b[0], _mm256_fmadd_ps(a[1], b[1], _mm256_mul_ps(a[2], b[2]))) }
}
