//! Rays against boxes and split planes, conservatively and at any scale.

use super::triangle::{larger, smaller};
use super::{Aabb, Ray, RayFrame, Vec3};

/// The power of two by which a structure stores its planes, so that plane distances neither over- nor underflow.
///
/// 1 for all ordinary scenes. Multiplying by it is exact, so that it changes no decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale(f32);

impl Scale {
    /// Coordinates up to 2²⁰ in size, and down to 2⁻²⁰ in all, are left alone.
    pub fn of(bounds: &Aabb) -> Self {
        Self(power_of_two_near_one(bounds.magnitude(), 20))
    }

    /// The factor.
    #[inline(always)]
    pub fn factor(self) -> f32 {
        self.0
    }

    /// A box in the scaled space.
    pub fn scaled(self, bounds: &Aabb) -> Aabb {
        Aabb { min: bounds.min.map(|x| x * self.0), max: bounds.max.map(|x| x * self.0) }
    }
}

/// 1 if `x` lies within 2^±`range`, else the power of two that brings it near 1 (as far as f32 has it).
#[inline(always)]
fn power_of_two_near_one(x: f32, range: i32) -> f32 {
    let exponent = ((x.to_bits() >> 23) & 0xff) as i32 - 127;
    if exponent.abs() <= range || x == 0.0 {
        return 1.0;
    }
    f32::from_bits(((127 - exponent).clamp(1, 254) as u32) << 23)
}

/// A ray made ready for the planes of one structure, in that structure's scaled space.
///
/// Every plane counts as wide as [`RayFrame::slack`] on both sides: the cells a ray visits are those that the ray,
/// thickened by the slack, meets. By the argument in `geom/triangle.rs` no hit lies elsewhere.
#[derive(Debug, Clone, Copy)]
pub struct PlaneFrame {
    /// The ray's origin, scaled.
    pub origin: Vec3,
    /// The reciprocal of the direction: finite, with the direction's sign (that of a zero too).
    pub inverse: Vec3,
    /// By how much, in `t`, a plane is widened on each side.
    pub pad: Vec3,
    /// The ray's own interval, in this space.
    pub t_min: f32,
    /// The ray's own interval, in this space.
    pub t_max: f32,
    /// Where the ray enters the structure's box, not before its own `t_min`.
    pub t_near: f32,
    /// Where it leaves the box, not after its own `t_max`; smaller than `t_near` if it misses.
    pub t_far: f32,
    /// This space's `t` for 1 of the ray's.
    t_scale: f64,
}

impl PlaneFrame {
    /// A direction component below this part of the largest counts as parallel to the plane:
    /// over the whole scene it moves the ray by 10⁻⁹ of the slack.
    const PARALLEL: f32 = 1e-15;
    /// Beyond this distance (in scaled space, where the structure lies within 2²¹) everything is visited:
    /// the slack is then larger than the structure.
    const FAR: f32 = (1u64 << 62) as f32;
    /// A reciprocal with which every plane of the structure is nearer than the pad, but those of absent boxes are not.
    const EVERYWHERE: f32 = 128.0;

    /// Prepares a valid ray for a structure that stores its planes by `scale`, in the box `bounds` (scaled too).
    #[inline(always)]
    pub fn new(ray: &Ray, scale: Scale, bounds: &Aabb, magnitude: f32) -> Self {
        let [dx, dy, dz] = ray.direction;
        let reach = larger(larger(dx.abs(), dy.abs()), dz.abs());
        let shorten = power_of_two_near_one(reach, 8);
        let t_scale = f64::from(scale.factor()) / f64::from(shorten);
        let [ox, oy, oz] = ray.origin;
        let origin = [ox * scale.factor(), oy * scale.factor(), oz * scale.factor()];
        let least = reach * shorten * Self::PARALLEL;
        let slack = RayFrame::slack(origin, magnitude);
        let (t_min, t_max) = if t_scale == 1.0 {
            (ray.t_min, ray.t_max)
        } else {
            ((f64::from(ray.t_min) * t_scale) as f32, (f64::from(ray.t_max) * t_scale) as f32)
        };
        if slack >= Self::FAR / (1 << 21) as f32 {
            return Self {
                origin: [0.0; 3],
                inverse: [Self::EVERYWHERE; 3],
                pad: [f32::MAX / 4.0; 3],
                t_min,
                t_max,
                t_near: t_min,
                t_far: t_max,
                t_scale,
            };
        }
        let ([dx, dy, dz], min, max) = (ray.direction, bounds.min, bounds.max);
        let x = Slab::new(origin[0], dx * shorten, least, slack, (min[0], max[0]));
        let y = Slab::new(origin[1], dy * shorten, least, slack, (min[1], max[1]));
        let z = Slab::new(origin[2], dz * shorten, least, slack, (min[2], max[2]));
        Self {
            origin,
            inverse: [x.inverse, y.inverse, z.inverse],
            pad: [x.pad, y.pad, z.pad],
            t_min,
            t_max,
            t_near: larger(larger(t_min, x.near), larger(y.near, z.near)),
            t_far: smaller(smaller(t_max, x.far), smaller(y.far, z.far)),
            t_scale,
        }
    }

    /// The ray's `t` in this space.
    #[inline(always)]
    pub fn scaled_t(&self, t: f32) -> f32 {
        (f64::from(t) * self.t_scale) as f32
    }
}

/// A ray against the two faces of a box across one axis.
struct Slab {
    inverse: f32,
    pad: f32,
    near: f32,
    far: f32,
}

impl Slab {
    #[inline(always)]
    fn new(origin: f32, direction: f32, least: f32, slack: f32, (low, high): (f32, f32)) -> Self {
        let direction = if direction.abs() >= least { direction } else { least.copysign(direction) };
        let inverse = 1.0 / direction;
        let pad = slack * inverse.abs();
        let (t0, t1) = ((low - origin) * inverse, (high - origin) * inverse);
        Self { inverse, pad, near: smaller(t0, t1) - pad, far: larger(t0, t1) + pad }
    }
}
