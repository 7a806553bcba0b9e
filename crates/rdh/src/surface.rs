//! What a hit means on its mesh: the point, the normal, values between the corners, and rays that go on from there.

use crate::geom::{Hit, Ray, RayFrame, TriId, Vec3};
use crate::mesh::Mesh;

impl Hit {
    /// The weights of the triangle's three corners; their sum is 1.
    pub fn weights(&self) -> [f32; 3] {
        [1.0 - self.u - self.v, self.u, self.v]
    }
}

impl Mesh {
    /// The point that was hit, from the triangle's corners: nearer to the surface than `ray.at(hit.t)`.
    pub fn point(&self, hit: &Hit) -> Vec3 {
        self.exact_point(hit).map(|x| x as f32)
    }

    /// The triangle's geometric normal, of length 1, on the side from which its corners run counter-clockwise; nothing if the
    /// triangle has no area.
    pub fn normal(&self, tri: TriId) -> Option<Vec3> {
        unit(self.exact_normal(tri)).map(|n| n.map(|x| x as f32))
    }

    /// What `values`, given at the vertices (normals, colours, texture coordinates), come to at a hit: linear in the triangle.
    ///
    /// # Panics
    /// Unless there is one value a vertex.
    pub fn interpolate<const N: usize>(&self, hit: &Hit, values: &[[f32; N]]) -> [f32; N] {
        assert_eq!(values.len(), self.positions().len(), "one value a vertex is needed");
        let corners = self.triangles()[hit.tri.index()].map(|vertex| values[vertex as usize]);
        let weights = hit.weights();
        std::array::from_fn(|i| (0..3).map(|c| weights[c] * corners[c][i]).sum())
    }

    /// A ray from a hit along `direction`, on either side of the surface, that cannot hit the same triangle again; it sees
    /// all masks. Its origin is moved off the triangle by the least distance for which that is certain.
    ///
    /// A hit lies within [`RayFrame::slack`] of its triangle in each coordinate, so within √3 of that along its normal; the
    /// rounding of the point takes another fifth. Beyond that, on the side to which the ray goes, it meets the triangle at no `t >= 0`.
    pub fn spawn(&self, hit: &Hit, direction: Vec3) -> Ray {
        let (point, along) = (self.exact_point(hit), direction.map(f64::from));
        let normal = unit(self.exact_normal(hit.tri)).unwrap_or_else(|| self.across(hit.tri, along));
        let side = if dot(normal, along) < 0.0 { -1.0 } else { 1.0 };
        let magnitude = self.corners(hit.tri).as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        let slack = f64::from(RayFrame::slack(self.point(hit), magnitude)).max(Self::LEAST_SLACK);
        let off = side * Self::OFF_IN_SLACKS * slack;
        Ray::new([0, 1, 2].map(|a| (point[a] + off * normal[a]) as f32), direction)
    }

    /// How far spawned rays start from their triangle, in slacks. √3 for the hit, and room for the rounding of both origins.
    const OFF_IN_SLACKS: f64 = 2.0;
    /// The slack where coordinates are so small that f32 has but their last bits: eight of its smallest steps.
    const LEAST_SLACK: f64 = f32::from_bits(8) as f64;

    /// In f64, so that it lies in the triangle's plane.
    fn exact_point(&self, hit: &Hit) -> [f64; 3] {
        let (corners, [u, v]) = (self.corners(hit.tri), [hit.u, hit.v].map(f64::from));
        let corner = |c: usize, a: usize| f64::from(corners[c][a]);
        [0, 1, 2].map(|a| corner(0, a) + u * (corner(1, a) - corner(0, a)) + v * (corner(2, a) - corner(0, a)))
    }

    fn exact_normal(&self, tri: TriId) -> [f64; 3] {
        let [a, b, c] = self.corners(tri).map(|corner| corner.map(f64::from));
        cross(minus(b, a), minus(c, a))
    }

    /// For a triangle without area: a direction across its longest edge, as near to `along` as can be.
    fn across(&self, tri: TriId, along: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.corners(tri).map(|corner| corner.map(f64::from));
        let edges = [minus(b, a), minus(c, b), minus(a, c)];
        let edge = edges.into_iter().max_by(|p, q| dot(*p, *p).total_cmp(&dot(*q, *q))).unwrap_or_default();
        let Some(edge) = unit(edge) else { return unit(along).unwrap_or_default() };
        let part = dot(along, edge);
        unit([0, 1, 2].map(|i| along[i] - part * edge[i])).unwrap_or_default()
    }
}

/// The same direction, of length 1, whatever its length; nothing for 0.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let most = v.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if most == 0.0 {
        return None;
    }
    // Squares of small numbers would vanish.
    let v = v.map(|x| x / most);
    let length = dot(v, v).sqrt();
    Some(v.map(|x| x / length))
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}
