//! THE triangle test in f64: that of `geom/triangle.rs`, with exact signs by splitting products.
//!
//! A corner's sheared point depends on the ray and the corner alone, and the signs of the edge functions are exact, so there are no
//! gaps: section 1 of docs/watertight.md holds word for word, with 2⁻⁵³ for 2⁻²⁴. What is computed is scaled by powers of two, the same
//! for all triangles of a mesh, so that nothing of it over- or underflows that is not far below rounding.

use super::exact;
use super::mesh::MeshF64;
use super::powers::{exponent_above, times_power};
use super::ray::{HitF64, RayF64};
use crate::geom::TriId;

/// A valid ray made ready: the shear that turns it into the z axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// The axes that become x, y and z; z is the one along which the ray moves most.
    k: [usize; 3],
    origin: [f64; 3],
    shear: [f64; 2],
    /// The direction's component along z, brought near 1.
    direction_z: f64,
    /// 2 to this scales differences of corner and origin so that none is above ¼.
    exponent: i32,
    /// 2 to this makes the ray's `t` of that in scaled numbers.
    t_exponent: i32,
    t_min: f64,
    t_max: f64,
}

/// A triangle in a ray's frame: its corners' x and y, scaled by the frame and then brought near 1; their depths, scaled by the frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheared {
    x: [f64; 3],
    y: [f64; 3],
    z: [f64; 3],
}

impl Frame {
    /// Prepares a valid ray for a mesh.
    pub(super) fn new(ray: &RayF64, mesh: &MeshF64) -> Self {
        let [x, y, z] = ray.direction.map(f64::abs);
        let k = if x > y && x > z {
            [1, 2, 0]
        } else if y > z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let [dx, dy, dz] = k.map(|a| ray.direction[a]);
        let (origin, shear) = (k.map(|a| ray.origin[a]), [dx / dz, dy / dz]);
        let reach = origin.iter().fold(mesh.reach(), |reach, x| reach.max(x.abs()));
        // The sum of two is below ¼, and what is sheared below ½.
        let (exponent, shorten) = (-exponent_above(reach) - 3, -exponent_above(dz.abs()));
        let direction_z = times_power(dz, shorten);
        let t_exponent = shorten - exponent;
        Self { k, origin, shear, direction_z, exponent, t_exponent, t_min: ray.t_min, t_max: ray.t_max }
    }

    /// The corners in this frame; nothing if they are too far away for numbers.
    fn shear(&self, corners: &[[f64; 3]; 3]) -> Option<Sheared> {
        let along = |a: usize| corners.map(|c| times_power(c[self.k[a]] - self.origin[a], self.exponent));
        let z = along(2);
        let across = |a: usize| {
            let straight = along(a);
            [0, 1, 2].map(|c| straight[c] - self.shear[a] * z[c])
        };
        let (x, y) = (across(0), across(1));
        let largest = x.iter().chain(&y).fold(0.0, |m: f64, c| m.max(c.abs()));
        // A maximum does not see a NaN.
        let finite = x.iter().chain(&y).all(|c| c.is_finite());
        let factor = near_one(largest);
        debug_assert!(!finite || largest < 0.5 && factor > 1.0);
        (finite && largest > 0.0).then(|| Sheared { x: x.map(|c| c * factor), y: y.map(|c| c * factor), z })
    }

    /// Tests one triangle; edges and corners count as hit, and so do both ends of the ray's interval.
    pub(super) fn hit(&self, corners: &[[f64; 3]; 3], tri: TriId) -> Option<(HitF64, Sheared)> {
        let p = self.shear(corners)?;
        let signs = EDGES.map(|[a, b]| exact::sign(p.x[a], p.y[b], p.y[a], p.x[b]));
        if signs.iter().any(|&s| s < 0.0) && signs.iter().any(|&s| s > 0.0) || signs == [0.0; 3] {
            return None;
        }
        // Needles need all bits of the weights.
        let w = EDGES.map(|[a, b]| exact::determinant(p.x[a], p.y[b], p.y[a], p.x[b]));
        let sum = w[0] + w[1] + w[2];
        let depth = (w[0] * p.z[0] + w[1] * p.z[1] + w[2] * p.z[2]) / sum;
        // Adding 0 turns -0 into 0, so that equal distances have equal bits.
        let t = times_power(depth / self.direction_z, self.t_exponent) + 0.0;
        let hit = HitF64 { t, u: w[1] / sum, v: w[2] / sum, tri };
        (t >= self.t_min && t <= self.t_max && t.is_finite()).then_some((hit, p))
    }
}

/// The edge across from each corner, in the orientation of `geom/triangle.rs`.
const EDGES: [[usize; 2]; 3] = [[2, 1], [0, 2], [1, 0]];

/// The power of two that brings a number below ½ to between 1 and 2, as far as there is one.
fn near_one(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) as i64 - 1023;
    f64::from_bits(((1023 - exponent.max(-1023)) as u64) << 52)
}

/// Whether a triangle that was hit also owns the crossing, as [`owns_crossing`](crate::geom::owns_crossing) has it.
pub(super) fn owns(p: &Sheared) -> bool {
    let sign = |[a, b]: [usize; 2]| {
        let by_edge = exact::sign(p.x[a], p.y[b], p.y[a], p.x[b]);
        let by_y = p.y[a] - p.y[b];
        let by_x = p.x[b] - p.x[a];
        [by_edge, by_y, by_x].into_iter().find(|&x| x != 0.0).map_or(0.0, f64::signum)
    };
    let signs = EDGES.map(sign);
    signs[0] != 0.0 && signs.iter().all(|&s| s == signs[0])
}
