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

    /// A box of the scaled space as it is in the mesh's.
    pub fn unscaled(self, bounds: &Aabb) -> Aabb {
        Aabb { min: bounds.min.map(|x| x / self.0), max: bounds.max.map(|x| x / self.0) }
    }
}

/// Whether `x`, not negative, lies within 2^±`range`; or is 0.
#[inline(always)]
fn is_near_one(x: f32, range: u32) -> bool {
    let exponent = (x.to_bits() >> 23).wrapping_sub(127 - range);
    exponent <= 2 * range || x == 0.0
}

/// 1 if `x` lies within 2^±`range`, else the power of two that brings it near 1 (as far as f32 has it).
#[inline(always)]
fn power_of_two_near_one(x: f32, range: u32) -> f32 {
    if is_near_one(x, range) {
        return 1.0;
    }
    let exponent = ((x.to_bits() >> 23) & 0xff) as i32 - 127;
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
    /// By how much a plane is widened on each side …
    pub slack: f32,
    /// … and that in `t`.
    pub pad: Vec3,
    /// The ray's own interval, in this space; without ends for a ray that starts too far away.
    pub t_min: f32,
    /// The ray's own interval, in this space; without ends for a ray that starts too far away.
    pub t_max: f32,
    /// This space's `t` for 1 of the ray's; 0 for a ray that starts too far away.
    t_scale: f64,
}

impl PlaneFrame {
    /// A direction component below this counts as parallel to the plane: it is at most 2⁻⁵⁰ of the largest one, and over the
    /// whole scene moves the ray by 10⁻⁹ of the slack.
    pub(crate) const PARALLEL: f32 = 1.0 / (1u64 << 58) as f32;
    /// Beyond this distance (in scaled space, where the structure lies within 2²¹) everything is visited:
    /// the slack is then larger than the structure.
    pub(crate) const FAR: f32 = (1u64 << 62) as f32;
    /// A reciprocal with which every plane of the structure is nearer than the pad, but those of absent boxes are not.
    const EVERYWHERE: f32 = 128.0;

    /// Prepares a valid ray for a structure that stores its planes by `scale`, within `magnitude` of the origin (scaled too).
    #[inline(always)]
    pub fn new(ray: &Ray, scale: Scale, magnitude: f32) -> Self {
        let [dx, dy, dz] = ray.direction;
        let reach = larger(larger(dx.abs(), dy.abs()), dz.abs());
        let slack = RayFrame::slack(ray.origin, magnitude);
        // Almost always nothing has to be scaled, and the ray starts nearby.
        if scale.factor() == 1.0 && is_near_one(reach, Self::UNITS) && slack < Self::FAR_SLACK {
            return Self::nearby(ray.origin, ray.direction, slack, (ray.t_min, ray.t_max), 1.0);
        }
        Self::unusual(ray, scale, magnitude, reach)
    }

    /// Whether a ray needs no care where planes are not scaled: it is valid, neither far away nor of extreme length.
    pub(crate) fn is_usual(ray: &Ray) -> bool {
        let size = |[x, y, z]: Vec3| larger(larger(x.abs(), y.abs()), z.abs());
        let (far, reach) = (size(ray.origin), size(ray.direction));
        ray.is_valid() && far < Self::FAR && (Self::SHORT..=Self::LONG).contains(&reach)
    }

    /// Directions of a length within 2^±UNITS are left alone.
    pub(crate) const UNITS: u32 = 8;
    /// The largest size of a component of a direction that is surely left alone, …
    pub(crate) const LONG: f32 = ((2 << Self::UNITS) as f32).next_down();
    /// … and the smallest one that its largest component must have.
    pub(crate) const SHORT: f32 = 1.0 / (1 << Self::UNITS) as f32;
    /// The slack of rays that start too far away to tell planes apart.
    const FAR_SLACK: f32 = Self::FAR / (1 << 21) as f32;

    /// A ray whose planes can be told apart, in scaled space and units.
    #[inline(always)]
    fn nearby(origin: Vec3, direction: Vec3, slack: f32, (t_min, t_max): (f32, f32), t_scale: f64) -> Self {
        // Four lanes, so that one vector does all: the last one is not used.
        let d = [direction[0], direction[1], direction[2], 1.0];
        let inverse = d.map(|d| 1.0 / if d.abs() >= Self::PARALLEL { d } else { Self::PARALLEL.copysign(d) });
        let pad = inverse.map(|x| slack * x.abs());
        let ([ix, iy, iz, _], [px, py, pz, _]) = (inverse, pad);
        Self { origin, inverse: [ix, iy, iz], slack, pad: [px, py, pz], t_min, t_max, t_scale }
    }

    #[cold]
    #[inline(never)]
    fn unusual(ray: &Ray, scale: Scale, magnitude: f32, reach: f32) -> Self {
        let shorten = power_of_two_near_one(reach, Self::UNITS);
        // Powers of two: the reciprocal is exact.
        let t_scale = f64::from(scale.factor()) * f64::from(1.0 / shorten);
        let origin = ray.origin.map(|x| x * scale.factor());
        let slack = RayFrame::slack(origin, magnitude);
        if slack < Self::FAR_SLACK {
            let interval = ((f64::from(ray.t_min) * t_scale) as f32, (f64::from(ray.t_max) * t_scale) as f32);
            let direction = ray.direction.map(|x| x * shorten);
            return Self::nearby(origin, direction, slack, interval, t_scale);
        }
        Self::everywhere()
    }

    /// A ray whose planes cannot be told apart meets every box, wherever it begins and ends: what it hits may lie at any `t`, so
    /// that its own interval, and where it hit something, are left to the triangle test.
    fn everywhere() -> Self {
        let (inverse, pad) = ([Self::EVERYWHERE; 3], [f32::MAX / 4.0; 3]);
        let slack = f32::MAX / 4.0 / Self::EVERYWHERE;
        let (t_min, t_max) = (f32::NEG_INFINITY, f32::INFINITY);
        Self { origin: [0.0; 3], inverse, slack, pad, t_min, t_max, t_scale: 0.0 }
    }

    /// Where the ray enters a box and where it leaves it, within its own interval; it misses if that is empty.
    #[inline(always)]
    pub fn span(&self, bounds: &Aabb) -> (f32, f32) {
        let (mut near, mut far) = (self.t_min, self.t_max);
        for a in 0..3 {
            let (low, high) = (bounds.min[a] - self.origin[a], bounds.max[a] - self.origin[a]);
            let (t0, t1) = (low * self.inverse[a], high * self.inverse[a]);
            near = larger(near, smaller(t0, t1) - self.pad[a]);
            far = smaller(far, larger(t0, t1) + self.pad[a]);
        }
        (near, far)
    }

    /// This space's `t` for 1 of the ray's: a power of two, or 0 where `t` tells nothing apart.
    #[inline(always)]
    pub(crate) fn t_scale(&self) -> f64 {
        self.t_scale
    }

    /// The ray's `t` in this space.
    #[inline(always)]
    pub fn scaled_t(&self, t: f32) -> f32 {
        (f64::from(t) * self.t_scale) as f32
    }
}
