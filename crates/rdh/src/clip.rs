//! Perfect splits: the parts of a triangle on both sides of a plane.
//!
//! The triangle is cut at the one plane and each part's box is cut with the box that the reference had: measured in
//! prototypes to give the same trees as clipping to all six sides, at half the price. Cuts are widened by more than their
//! rounding, so that no part of the triangle is ever lost.

use crate::geom::{Aabb, Axis, Vec3};
use crate::mesh::Mesh;
use crate::simd::Four;

/// What cuts primitives: builders know boxes and a clipper, never a mesh.
pub(crate) trait Clipper: Sync {
    /// The boxes of the parts, on both sides of a plane, of that part of a primitive that lies in `bounds`. Conservative: the parts
    /// lie in them. An empty box says that there is nothing on that side.
    #[inline(always)]
    fn split(&self, id: u32, bounds: &Aabb, axis: Axis, plane: f32) -> (Aabb, Aabb) {
        let slope = self.slope(id, axis);
        let (left, right) = slope.split(plane);
        (left.intersection(bounds), right.intersection(bounds))
    }

    /// A primitive, made ready to be cut by planes across an axis.
    fn slope(&self, id: u32, axis: Axis) -> Slope;
}

/// Cuts a mesh's triangles, in the structure's scaled space.
pub(crate) struct TriangleClipper<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) scale: f32,
}

impl TriangleClipper<'_> {
    /// The scaled corners of a triangle.
    #[inline(always)]
    pub(crate) fn corners(&self, id: u32) -> [Vec3; 3] {
        self.mesh.triangles()[id as usize].map(|i| self.mesh.positions()[i as usize].map(|x| x * self.scale))
    }
}

impl Clipper for TriangleClipper<'_> {
    #[inline(always)]
    fn slope(&self, id: u32, axis: Axis) -> Slope {
        Slope::new(&self.corners(id), axis)
    }
}

/// The boxes of a triangle's parts on both sides of a plane; the plane itself belongs to both.
pub(crate) fn split_triangle(corners: &[Vec3; 3], axis: Axis, plane: f32) -> (Aabb, Aabb) {
    Slope::new(corners, axis).split(plane)
}

/// A box in lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slice {
    pub(crate) min: Four,
    pub(crate) max: Four,
}

impl Slice {
    /// Holds nothing.
    pub(crate) const EMPTY: Self = Self { min: Four::INFINITY, max: Four::NEG_INFINITY };

    /// The smallest box around both.
    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// What both have in common.
    #[inline(always)]
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The box.
    #[inline(always)]
    pub(crate) fn bounds(self) -> Aabb {
        Aabb { min: self.min.to_point(), max: self.max.to_point() }
    }
}

impl From<Four> for Slice {
    /// A point.
    #[inline(always)]
    fn from(point: Four) -> Self {
        Self { min: point, max: point }
    }
}

/// A triangle with its corners in order along an axis, and how its edges run across.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slope {
    axis: Axis,
    /// The lowest, the middle and the highest corner.
    corners: [Four; 3],
    /// Where they lie on the axis.
    at: Vec3,
    long: Edge,
    lower: Edge,
    upper: Edge,
}

/// An edge, from its lower end.
#[derive(Debug, Clone, Copy)]
struct Edge {
    start: Four,
    start_at: f32,
    /// How far it runs across for each step along the axis.
    per_step: Four,
    /// What a point on it may be off, beside what depends on the point.
    slack: Four,
}

/// Twice the largest relative error of one rounding.
const EPSILON: f32 = f32::EPSILON;
/// Edges that are shorter along the axis are not cut but taken whole: their slopes might not be numbers.
const SHORTEST: f32 = 1e-18;

impl Edge {
    #[inline(always)]
    fn new((start, start_at): (Four, f32), (end, end_at): (Four, f32)) -> Self {
        let (across, along) = (end - start, end_at - start_at);
        let (per_step, slack) = if along > SHORTEST {
            (across * Four::splat(1.0 / along), Four::splat(f32::MIN_POSITIVE))
        } else {
            (Four::splat(0.0), across.abs() * Four::splat(1.0 + EPSILON) + Four::splat(f32::MIN_POSITIVE))
        };
        Self { start, start_at, per_step, slack }
    }

    /// A box around the point where a plane meets it.
    ///
    /// What is added to the start has gone through six roundings, and the sum through one: of the last product, of the slope (two
    /// differences, a reciprocal, a product) and of the step. Half an `EPSILON` each makes 3 and ½; another ½ is for widening.
    #[inline(always)]
    fn at(&self, plane: f32) -> Slice {
        let step = self.per_step * Four::splat(plane - self.start_at);
        let point = self.start + step;
        let slack = step.abs() * Four::splat(4.0 * EPSILON) + point.abs() * Four::splat(1.5 * EPSILON) + self.slack;
        Slice { min: point - slack, max: point + slack }
    }
}

impl Slope {
    #[inline(always)]
    fn new(corners: &[Vec3; 3], axis: Axis) -> Self {
        let a = axis.index();
        let [mut p, mut q, mut r] = *corners;
        if q[a] < p[a] {
            std::mem::swap(&mut p, &mut q);
        }
        if r[a] < q[a] {
            std::mem::swap(&mut q, &mut r);
            if q[a] < p[a] {
                std::mem::swap(&mut p, &mut q);
            }
        }
        let at = [p[a], q[a], r[a]];
        let corners = [p, q, r].map(Four::point);
        let [low, middle, high] = [(corners[0], at[0]), (corners[1], at[1]), (corners[2], at[2])];
        let edges = (Edge::new(low, high), Edge::new(low, middle), Edge::new(middle, high));
        Self { axis, corners, at, long: edges.0, lower: edges.1, upper: edges.2 }
    }

    /// A box around what a plane cuts out; planes beside the triangle are moved to its end.
    #[inline(always)]
    pub(crate) fn section(&self, plane: f32) -> Slice {
        let plane = if plane > self.at[0] { plane } else { self.at[0] };
        let plane = if plane < self.at[2] { plane } else { self.at[2] };
        let short = if plane < self.at[1] { &self.lower } else { &self.upper };
        self.long.at(plane).union(short.at(plane))
    }

    /// A box around what lies between two planes, of which the sections are given.
    #[inline(always)]
    pub(crate) fn between(&self, (from, first): (f32, Slice), (to, last): (f32, Slice)) -> Slice {
        let both = first.union(last);
        if from <= self.at[1] && self.at[1] <= to { both.union(self.corners[1].into()) } else { both }
    }

    /// The boxes of the parts on both sides of a plane; the plane itself belongs to both.
    #[inline(always)]
    fn split(&self, plane: f32) -> (Aabb, Aabb) {
        let [low, middle, high] = self.corners;
        let whole = Slice::from(low).union(middle.into()).union(high.into());
        if plane < self.at[0] {
            return (Aabb::EMPTY, whole.bounds());
        }
        if plane > self.at[2] {
            return (whole.bounds(), Aabb::EMPTY);
        }
        let cut = (plane, self.section(plane).intersection(whole));
        let left = self.between((self.at[0], low.into()), cut);
        let right = self.between(cut, (self.at[2], high.into()));
        let (mut left, mut right) = (left.bounds(), right.bounds());
        (left.max[self.axis.index()], right.min[self.axis.index()]) = (plane, plane);
        (left, right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_through_the_middle_halves_the_box() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let (left, right) = split_triangle(&corners, Axis::X, 1.0);
        assert_eq!((left.min, left.max[0]), ([0.0; 3], 1.0));
        assert_eq!((right.min[0], right.max[0]), (1.0, 2.0));
        assert!(right.max[1] >= 1.0 && right.max[1] < 1.0001, "the right part is lower: {right:?}");
        assert_eq!(left.max[1], 2.0);
    }

    #[test]
    fn a_corner_in_the_plane_is_on_both_sides() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 3.0]];
        let (left, right) = split_triangle(&corners, Axis::X, 1.0);
        assert_eq!(left, Aabb::around(&corners));
        assert_eq!(right, Aabb { min: [1.0, 0.0, 0.0], max: [1.0, 1.0, 3.0] });
    }

    /// Points of each edge, computed in f64, lie in the part of their side; and parts are no larger than they must be.
    #[test]
    fn parts_hold_their_points_and_little_more() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Far and near, small and large, and often the same.
            let size = [1.0, 1e-3, 1000.0, 1e-20, 1e-30][(state >> 33) as usize % 5];
            ((state >> 60) as f32 - 8.0) * size + ((state >> 40) & 3) as f32
        };
        let mut halves = 0;
        for _ in 0..20_000 {
            let corners: [Vec3; 3] = std::array::from_fn(|_| [random(), random(), random()]);
            let (axis, plane) = (Axis::Y, random());
            let (left, right) = split_triangle(&corners, axis, plane);
            for i in 0..3 {
                let (p, q) = (corners[i].map(f64::from), corners[(i + 1) % 3].map(f64::from));
                for k in 0..=8 {
                    let s = f64::from(k) / 8.0;
                    let point: [f64; 3] = std::array::from_fn(|a| p[a] + s * (q[a] - p[a]));
                    // The points are rounded, too: next to the plane, either side will do.
                    let slack: [f64; 3] = std::array::from_fn(|a| 1e-14 * p[a].abs().max(q[a].abs()));
                    let holds = |part: &Aabb| {
                        (0..3).all(|a| {
                            f64::from(part.min[a]) - slack[a] <= point[a]
                                && point[a] <= f64::from(part.max[a]) + slack[a]
                        })
                    };
                    let above = point[1] - f64::from(plane);
                    let (may_left, may_right) = (above <= slack[1], above >= -slack[1]);
                    let held = may_left && holds(&left) || may_right && holds(&right);
                    assert!(held, "{point:?} of {corners:?} is in neither {left:?} nor {right:?}, cut at {plane}");
                }
            }
            let whole = Aabb::around(&corners);
            for part in [left, right].iter().filter(|part| !part.is_empty()) {
                assert_eq!(part.intersection(&whole), *part, "a part is no larger than the whole");
            }
            halves += usize::from(!left.is_empty() && !right.is_empty());
        }
        assert!(halves > 2000, "{halves}");
    }
}
