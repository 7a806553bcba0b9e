//! Images in f32: of a mesh, moved so that its middle is 0 and scaled so that it reaches to 1 or a little less, and of rays there.
//!
//! With `u` = 2⁻²⁴, a corner's image lies within u of the corner (in scaled units, on each axis), since the mesh reaches to 1 at most.
//! A ray's image starts within u R of where the ray does, R being how far off that is, and at `t` it has gone wrong by
//! u · |t d| ≤ u (R + 1) more. So where the ray meets a triangle its image is within 2u (R + 1) of the triangle's image, and the slack
//! of a walk holds that: docs/watertight.md, "Double precision". What f64 rounds is 2⁻²⁸ of it.

use super::mesh::MeshF64;
use super::powers::{exponent_above, times_power};
use super::ray::{HitF64, RayF64};
use crate::error::Result;
use crate::geom::{GeomId, Hit, InstId, Ray, Vec3};
use crate::mesh::Mesh;

/// How a mesh is moved and scaled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coarse {
    /// The middle of the mesh.
    middle: [f64; 3],
    /// Then scaled by 2 to this.
    exponent: i32,
}

/// A ray's image, and how its `t` are made of the ray's.
#[derive(Debug, Clone, Copy)]
pub(super) struct Image {
    pub(super) ray: Ray,
    exponent: i32,
    /// By how much its start was moved along it, in its own `t`.
    ahead: f64,
}

/// A ray that starts farther away is moved towards the mesh first, …
const NEAR: f64 = 4.0;
/// … unless f64 can't do that within a 16th of u.
const FAR: f64 = (1u64 << 20) as f64;
/// Beyond this all of a structure is visited; the same in f32.
const EVERYWHERE: f64 = (1u128 << 100) as f64;
/// By how much an end of a ray's interval is moved outwards: more than f64 rounds within [`FAR`], less than u.
const PAD: f64 = 1.0 / (1u64 << 26) as f64;

impl Coarse {
    pub(super) fn of(mesh: &MeshF64) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &i in mesh.triangles().as_flattened() {
            let p = mesh.positions()[i as usize];
            (min, max) = ([0, 1, 2].map(|a| min[a].min(p[a])), [0, 1, 2].map(|a| max[a].max(p[a])));
        }
        if mesh.is_empty() {
            return Self { middle: [0.0; 3], exponent: 0 };
        }
        let middle = [0, 1, 2].map(|a| min[a] * 0.5 + max[a] * 0.5);
        let reach = (0..3).fold(0.0, |reach: f64, a| reach.max(middle[a] - min[a]).max(max[a] - middle[a]));
        Self { middle, exponent: -exponent_above(reach) }
    }

    /// Where a point's image is, in f64.
    fn place(&self, p: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| times_power(p[a] - self.middle[a], self.exponent))
    }

    /// The mesh's image.
    pub(super) fn mesh(&self, mesh: &MeshF64) -> Result<Mesh> {
        // Vertices that no triangle uses may lie anywhere.
        let image = |p: &[f64; 3]| -> Vec3 { self.place(p).map(|x| x.clamp(-2.0, 2.0) as f32) };
        let image =
            Mesh::of_arrays(mesh.positions().iter().map(image).collect::<Vec<_>>().into(), mesh.triangle_array())?;
        mesh.masks().map_or(Ok(image.clone()), |masks| image.with_masks(masks.to_vec()))
    }

    /// A ray's image, which reaches at least as far; nothing if the ray is invalid.
    pub(super) fn image(&self, ray: &RayF64) -> Option<Image> {
        if !ray.is_valid() {
            return None;
        }
        let longest = ray.direction.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        // Half of what is above it: components are between 1 and 2 then.
        let shorten = 1 - exponent_above(longest);
        let direction = ray.direction.map(|d| times_power(d, shorten));
        let (start, ahead) = nearer(self.place(&ray.origin), &direction);
        let mut image = Image { ray: Ray::new([0.0; 3], [0.0; 3]), exponent: self.exponent - shorten, ahead };
        image.ray = Ray {
            origin: start.map(|x| x.clamp(-EVERYWHERE, EVERYWHERE) as f32),
            direction: direction.map(|d| d as f32),
            t_min: image.before(ray.t_min),
            t_max: image.behind(ray.t_max),
            mask: ray.mask,
        };
        Some(image)
    }
}

/// The same ray from where it passes the middle of the mesh, if it starts far away; and its `t` there.
fn nearer(start: [f64; 3], direction: &[f64; 3]) -> ([f64; 3], f64) {
    let reach = start.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if !(reach > NEAR && reach < FAR) {
        return (start, 0.0);
    }
    let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let ahead = -dot(&start, direction) / dot(direction, direction);
    ([0, 1, 2].map(|a| start[a] + ahead * direction[a]), ahead)
}

impl Image {
    /// The image's `t` for one of the ray's, in f64.
    fn t(&self, t: f64) -> f64 {
        times_power(t, self.exponent) - self.ahead
    }

    /// A number in f32 that is surely not above it, nor above what was rounded to it.
    fn before(&self, t: f64) -> f32 {
        let t = self.t(t.next_down()) - PAD;
        // Rounded to the nearest; a step down is more.
        if t == f64::NEG_INFINITY { f32::NEG_INFINITY } else { (t as f32).next_down() }
    }

    /// A number in f32 that is surely not below it, nor below what was rounded to it.
    pub(super) fn behind(&self, t: f64) -> f32 {
        let t = self.t(t.next_up()) + PAD;
        if t == f64::INFINITY { f32::INFINITY } else { (t as f32).next_up() }
    }

    /// A hit as the image has it.
    pub(super) fn hit(&self, hit: &HitF64) -> Hit {
        let (geometry, instance) = (GeomId(0), InstId(0));
        Hit { t: self.t(hit.t) as f32, u: hit.u as f32, v: hit.v as f32, tri: hit.tri, geometry, instance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_moved_outwards() {
        let image = Image { ray: Ray::new([0.0; 3], [1.0; 3]), exponent: 3, ahead: 0.1 };
        for t in [0.0, 1.0, 1e-300, 7.123_456_789, -3.0, 1e30] {
            let exact = t * 8.0 - 0.1;
            assert!(f64::from(image.before(t)) < exact && f64::from(image.behind(t)) > exact, "{t:e}");
        }
        assert_eq!(image.behind(f64::INFINITY), f32::INFINITY);
        assert_eq!(image.before(f64::NEG_INFINITY), f32::NEG_INFINITY);
    }
}
