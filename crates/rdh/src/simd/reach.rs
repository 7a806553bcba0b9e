//! Between which `t` a ray surely crosses a triangle, from edge functions in f32: what spares any-hit rays THE triangle test in f64.
//!
//! THE test's `t` times `D` lies within `E` of `N`, where the edge functions `w`, their sum `s` and the sheared corners are those of
//! f32 (docs/watertight.md, section 7):
//! ```text
//! N = Σ wᵢ zᵢ     D = |s d_z|     E = 2⁻²⁰ q m + 2⁻¹²⁴ + 2⁻¹¹⁰ D     q = Σ xᵢ² + yᵢ²     m = max |zᵢ|
//! ```
//! `N` takes the sign of `s d_z`. Where something over- or underflows, `E` is infinite or no number, and nothing is said.

use super::{Floats, LANES, Sifted, all_lanes, size};
use crate::geom::Vec3;

/// Twice the largest error of `N` by rounding is less than this part of 2 q m, …
const ROUNDING: f32 = 1.0 / (1 << 21) as f32;
/// … with this added to 2 q, and to all, for products that underflow, …
const UNDERFLOW: f32 = 4.0 * f32::MIN_POSITIVE;
/// … and this part of `D`, because `t` itself may underflow: it is rounded to a multiple of 2⁻¹⁴⁹. It is larger than that, so that
/// no product with it is a slow, denormal number.
const LEAST_T: f32 = 1.0 / (1u128 << 110) as f32;

/// A triangle's edge functions and sheared corners.
pub(super) struct Sheared {
    pub(super) w: [f32; 3],
    pub(super) corners: [Vec3; 3],
}

/// In plain Rust: which of these lanes THE triangle test might accept within an interval of `t`, and which it surely does.
#[inline(always)]
pub(super) fn reached(
    mut lanes: u32,
    sheared: impl Fn(usize) -> Sheared,
    direction_z: f32,
    interval: (f32, f32),
) -> Sifted {
    let mut all = Sifted { possible: 0, certain: 0 };
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & (LANES - 1);
        lanes &= lanes - 1;
        let (possible, certain) = sheared(lane).is_reached(direction_z, interval);
        all.possible |= u32::from(possible) << lane;
        all.certain |= u32::from(certain) << lane;
    }
    all
}

/// The same of some triangles for one ray, or of one for some rays, all lanes of them: by the edge functions, the least and the
/// most of these, and the corners.
#[inline(always)]
pub(crate) fn reached_side_by_side<F: Floats>(
    &[u, v, w]: &[F; 3],
    (least, most): (F, F),
    [a, b, c]: &[[F; 3]; 3],
    direction_z: F,
    (t_min, t_max): (F, F),
) -> Sifted {
    let (zero, underflow) = (F::splat(0.0), F::splat(UNDERFLOW));
    let along = u.add(v).add(w).mul(direction_z);
    let depth = w.mul_add(c[2], v.mul_add(b[2], u.mul(a[2])));
    let (depth, along) = (depth.xor(along.and(F::splat(-0.0))), size(along));
    let farthest = size(a[2]).max(size(b[2])).max(size(c[2]));
    let x = a[0].mul_add(a[0], b[0].mul_add(b[0], c[0].mul(c[0])));
    let y = a[1].mul_add(a[1], b[1].mul_add(b[1], c[1].mul(c[1])));
    // Doubled, so that it overflows before the depth does.
    let error = x.add(y).mul_add(F::splat(2.0), underflow);
    let error = error.mul(farthest).mul_add(F::splat(ROUNDING), underflow);
    let error = along.mul_add(F::splat(LEAST_T), error);
    // All ones are no number.
    let error = error.or(along.lt(F::splat(f32::MIN_POSITIVE)));
    let (low, high) = (depth.sub(error), depth.add(error));
    // A `t` beyond f32's range is no hit.
    let first = along.mul(t_min.max(F::splat(f32::MIN)));
    let last = along.mul(t_max.min(F::splat(f32::MAX)));
    let outside = high.lt(first).or(last.lt(low));
    // An edge function that is no number hides in the least and the most, but makes the error none, too.
    let one_sign = zero.lt(least).or(most.lt(zero));
    let within = first.lt(low).and(high.lt(last));
    Sifted { possible: !outside.signs() & all_lanes::<F>(), certain: one_sign.and(within).signs() }
}

impl Sheared {
    /// Whether it might be, and whether it surely is.
    #[inline(always)]
    fn is_reached(&self, direction_z: f32, (t_min, t_max): (f32, f32)) -> (bool, bool) {
        let Self { w, corners: [a, b, c] } = self;
        let sum = (w[0] + w[1]) + w[2];
        let squares = |axis: usize| a[axis] * a[axis] + b[axis] * b[axis] + c[axis] * c[axis];
        let farthest = a[2].abs().max(b[2].abs()).max(c[2].abs());
        let size = sum * direction_z;
        // Doubled, so that it overflows before the depth does.
        let error = ((squares(0) + squares(1)) * 2.0 + UNDERFLOW) * farthest * ROUNDING + UNDERFLOW;
        let error = if size.abs() >= f32::MIN_POSITIVE { error + size.abs() * LEAST_T } else { f32::NAN };
        let depth = w[0] * a[2] + w[1] * b[2] + w[2] * c[2];
        let depth = if size < 0.0 { -depth } else { depth };
        let (low, high) = (depth - error, depth + error);
        // A `t` beyond f32's range is no hit.
        let (first, last) = (t_min.max(f32::MIN) * size.abs(), t_max.min(f32::MAX) * size.abs());
        let inside = (w[0] > 0.0 && w[1] > 0.0 && w[2] > 0.0) || (w[0] < 0.0 && w[1] < 0.0 && w[2] < 0.0);
        (!(high < first || low > last), inside && low > first && high < last)
    }
}
