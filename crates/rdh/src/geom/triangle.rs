//! THE triangle test: every structure, width and instruction set takes `t`, `u`, `v` from here.
//!
//! Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013, with two deviations:
//!
//! 1. The edge functions are formed in f64. A product of two f32 is exact there, so the sign of
//!    `a·b − c·d` is exact, zero included, at any scale: no fallback is needed and nothing over- or underflows.
//! 2. `t` is formed from unsheared depths in f64, so that needles keep their distance.
//!
//! Pseudo-code:
//! ```text
//! P_i   = (corner_i − origin) sheared so that the ray is the z axis        f32, one rounding rule for every triangle
//! U,V,W = edge functions of P_1P_2, P_2P_0, P_0P_1 at (0, 0)               f64, exact signs
//! miss if one is < 0 and one is > 0, or all are 0
//! t     = (U z_0 + V z_1 + W z_2) / ((U + V + W) d_z)
//! ```
//! *Why it is watertight.* A corner's sheared point depends on the ray and the corner alone, so the triangles around an
//! edge or a vertex see the same 2-D points, and exact signs leave no gap between them. The point found lies within
//! [`RayFrame::slack`] of the true triangle: corners are moved by a few ulps, and the point is a convex combination
//! of them. Box and plane tests that grow by that slack can therefore lose no hit.

use super::{GeomId, Hit, InstId, Ray, TriId, Vec3};

/// A ray made ready for [`Mesh`](crate::Mesh) triangles: the shear that turns it into the z axis.
///
/// One ray must use one frame in all its tests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayFrame {
    /// The axes that become x, y and z; z is the one along which the ray moves most.
    pub k: [usize; 3],
    /// The ray's origin, along the frame's axes.
    pub origin: Vec3,
    /// `d_x / d_z` and `d_y / d_z`.
    pub shear: [f32; 2],
    /// The direction's component along z.
    pub direction_z: f32,
    /// The interval of `t` that counts.
    pub t_min: f32,
    /// The interval of `t` that counts.
    pub t_max: f32,
}

impl RayFrame {
    /// Prepares a valid ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (ray.direction, ray.origin);
        // Selected, not indexed: an array indexed by a variable would go through memory.
        let (k, d, origin) = match Self::main_axis(&ray.direction) {
            0 => ([1, 2, 0], [y, z, x], [oy, oz, ox]),
            1 => ([2, 0, 1], [z, x, y], [oz, ox, oy]),
            _ => ([0, 1, 2], [x, y, z], [ox, oy, oz]),
        };
        let [dx, dy, dz] = d;
        Self { k, origin, shear: [dx / dz, dy / dz], direction_z: dz, t_min: ray.t_min, t_max: ray.t_max }
    }

    /// The axis along which a ray moves most.
    #[inline(always)]
    pub(crate) fn main_axis(&[x, y, z]: &Vec3) -> usize {
        if x.abs() > y.abs() && x.abs() > z.abs() {
            0
        } else if x.abs() <= y.abs() && y.abs() > z.abs() {
            1
        } else {
            2
        }
    }

    /// A corner's coordinates along the frame's axes.
    #[inline(always)]
    fn along(&self, corner: &Vec3) -> Vec3 {
        let [kx, ky, kz] = self.k;
        [corner[kx], corner[ky], corner[kz]]
    }

    /// How far, in each coordinate, a hit may lie from the true triangle, for geometry inside `bounds`.
    ///
    /// `corner − origin` is off by at most 2⁻²⁴ of its size on each axis; the shear adds the rounding of the quotient,
    /// the product and the difference. Less than 5 · 2⁻²⁴ (|origin| + |corner|) in all; 2⁻²¹ leaves room for the rounding of
    /// `t` itself and of the plane distances that are compared with it.
    #[inline(always)]
    pub fn slack(origin: Vec3, magnitude: f32) -> f32 {
        let reach = larger(larger(origin[0].abs(), origin[1].abs()), origin[2].abs());
        (reach + magnitude) * (1.0 / (1 << 21) as f32)
    }
}

/// The larger of two numbers that are not NaN; one instruction, where `f32::max` takes several.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers that are not NaN.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// A corner, given along the frame's axes, in the ray's frame: sheared x and y, unsheared depth.
#[inline(always)]
fn shear_point(frame: &RayFrame, [x, y, z]: Vec3) -> Vec3 {
    let z = z - frame.origin[2];
    // Separate product and difference: every instruction set must round alike, so never a fused multiply-add.
    let x = (x - frame.origin[0]) - frame.shear[0] * z;
    let y = (y - frame.origin[1]) - frame.shear[1] * z;
    [x, y, z]
}

/// The corners in the ray's frame.
#[inline(always)]
fn shear_corners(frame: &RayFrame, corners: &[Vec3; 3]) -> [Vec3; 3] {
    let [a, b, c] = corners;
    [shear_point(frame, frame.along(a)), shear_point(frame, frame.along(b)), shear_point(frame, frame.along(c))]
}

/// The cross product of two sheared points; its sign is exact.
#[inline(always)]
fn cross(a: &Vec3, b: &Vec3) -> f64 {
    f64::from(a[0]) * f64::from(b[1]) - f64::from(a[1]) * f64::from(b[0])
}

/// The edge functions of a sheared triangle at the ray: the weights of its corners, up to a common factor.
#[inline(always)]
fn edge_functions(p: &[Vec3; 3]) -> [f64; 3] {
    [cross(&p[2], &p[1]), cross(&p[0], &p[2]), cross(&p[1], &p[0])]
}

/// Tests one triangle; edges and corners count as hit, and so do both ends of the ray's interval.
#[inline(always)]
pub(crate) fn hit_triangle(frame: &RayFrame, corners: &[Vec3; 3], tri: TriId) -> Option<Hit> {
    hit_sheared(&shear_corners(frame, corners), frame.direction_z, (frame.t_min, frame.t_max), tri)
}

/// [`hit_triangle`] for corners that are in the ray's frame, and the interval of `t` that counts.
#[inline(always)]
pub(crate) fn hit_sheared(p: &[Vec3; 3], direction_z: f32, interval: (f32, f32), tri: TriId) -> Option<Hit> {
    let [t, u, v] = crossing(p, direction_z, interval)?;
    Some(Hit { t, u, v, tri, geometry: GeomId(0), instance: InstId(0) })
}

/// What is left of the test once the corners are in the ray's frame: `t`, `u` and `v`.
#[inline(always)]
pub(crate) fn crossing(p: &[Vec3; 3], direction_z: f32, (t_min, t_max): (f32, f32)) -> Option<Vec3> {
    let w = edge_functions(p);
    // Without short cuts: which side a triangle shows is as good as random, and a wrong guess costs more than all of it.
    let (some_below, some_above) =
        ((w[0] < 0.0) | (w[1] < 0.0) | (w[2] < 0.0), (w[0] > 0.0) | (w[1] > 0.0) | (w[2] > 0.0));
    if some_below & some_above {
        return None;
    }
    let sum = w[0] + w[1] + w[2];
    if sum == 0.0 {
        return None;
    }
    let depth = w[0] * f64::from(p[0][2]) + w[1] * f64::from(p[1][2]) + w[2] * f64::from(p[2][2]);
    // Adding 0 turns -0 into 0, so that equal distances have equal bits.
    let t = (depth / (sum * f64::from(direction_z))) as f32 + 0.0;
    // `t` can leave f32's range; an infinite one is no hit, even for `t_max = inf`.
    if !((t >= t_min) & (t <= t_max) & t.is_finite()) {
        return None;
    }
    Some([t, (w[1] / sum) as f32, (w[2] / sum) as f32])
}

/// Whether a triangle that was hit also *owns* the crossing, so that of the triangles around a shared edge or corner exactly
/// those count that a line moved by an infinitely small (ε, ε²) would cross: through a closed mesh always an even number.
///
/// Simulation of simplicity (Edelsbrunner and Mücke 1990): where the edge function of `a → b` is 0, moving the line
/// by (ε, ε²) gives it the sign of `a_y − b_y`, or of `b_x − a_x` where that is 0 too.
pub fn owns_crossing(frame: &RayFrame, corners: &[Vec3; 3]) -> bool {
    let p = shear_corners(frame, corners);
    let w = edge_functions(&p);
    let sign = |w: f64, a: &Vec3, b: &Vec3| {
        let by_y = f64::from(a[1]) - f64::from(b[1]);
        let by_x = f64::from(b[0]) - f64::from(a[0]);
        [w, by_y, by_x].into_iter().find(|&x| x != 0.0).map_or(0.0, f64::signum)
    };
    // The same orientation as in `edge_functions`: cross(b, a) is the function of the edge from b to a.
    let signs = [sign(w[0], &p[2], &p[1]), sign(w[1], &p[0], &p[2]), sign(w[2], &p[1], &p[0])];
    signs[0] != 0.0 && signs.iter().all(|&s| s == signs[0])
}
