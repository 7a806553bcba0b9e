//! A triangle test for competitors that are hierarchies of boxes only, and leave the triangles to their users.

use crate::engine::Ray;

/// A corner and two edges: Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection*, 1997.
#[derive(Debug, Clone, Copy)]
pub struct Triangle {
    corner: [f32; 3],
    edges: [[f32; 3]; 2],
}

impl Triangle {
    /// From its corners.
    pub fn new([a, b, c]: [[f32; 3]; 3]) -> Self {
        Self { corner: a, edges: [sub(b, a), sub(c, a)] }
    }

    /// Its corners.
    pub fn corners(&self) -> [[f32; 3]; 3] {
        let moved = |edge: [f32; 3]| std::array::from_fn(|axis| self.corner[axis] + edge[axis]);
        [self.corner, moved(self.edges[0]), moved(self.edges[1])]
    }

    /// The distance of the hit, if it lies between `t_min` and `t_max`; infinite for a miss. Both sides count.
    #[inline(always)]
    pub fn hit(&self, ray: &Ray, t_max: f32) -> f32 {
        let [ab, ac] = self.edges;
        let across = cross(ray.direction, ac);
        let inverse = 1.0 / dot(ab, across);
        let from = sub(ray.origin, self.corner);
        let along = cross(from, ab);
        let (u, v) = (dot(from, across) * inverse, dot(ray.direction, along) * inverse);
        let t = dot(ac, along) * inverse;
        // Comparisons with NaN fail: rays in the triangle's plane miss.
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        if inside && t >= ray.t_min && t <= t_max { t } else { f32::INFINITY }
    }
}

#[inline(always)]
fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_hit_from_both_sides_and_within_the_interval_only() {
        let triangle = Triangle::new([[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [0.0, 4.0, 2.0]]);
        let ray = |origin, z| Ray { origin, direction: [0.0, 0.0, z], t_min: 0.0, t_max: f32::INFINITY };
        assert_eq!(triangle.hit(&ray([1.0, 1.0, 0.0], 1.0), f32::INFINITY), 2.0);
        assert_eq!(triangle.hit(&ray([1.0, 1.0, 6.0], -2.0), f32::INFINITY), 2.0);
        assert_eq!(triangle.hit(&ray([1.0, 1.0, 0.0], 1.0), 1.9), f32::INFINITY);
        assert_eq!(triangle.hit(&ray([1.0, 1.0, 3.0], 1.0), f32::INFINITY), f32::INFINITY);
        assert_eq!(triangle.hit(&ray([3.0, 3.0, 0.0], 1.0), f32::INFINITY), f32::INFINITY);
        let flat = Ray { direction: [1.0, 0.0, 0.0], ..ray([-1.0, 1.0, 2.0], 0.0) };
        assert_eq!(triangle.hit(&flat, f32::INFINITY), f32::INFINITY);
    }
}
