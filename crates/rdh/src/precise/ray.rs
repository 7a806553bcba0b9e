//! Rays and hits in f64.

use crate::geom::TriId;

/// A ray in f64: the points `origin + t · direction` for `t_min <= t <= t_max`, as [`Ray`](crate::Ray).
///
/// A ray with a NaN, an infinite origin or direction, a zero direction or `t_min > t_max` is valid input: it hits nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayF64 {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes; any length but zero.
    pub direction: [f64; 3],
    /// The first `t` that counts.
    pub t_min: f64,
    /// The last `t` that counts; may be infinite.
    pub t_max: f64,
    /// Only triangles with a common bit are seen.
    pub mask: u32,
}

impl RayF64 {
    /// The whole half-line from `origin` along `direction`.
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY, mask: u32::MAX }
    }

    /// The same ray, limited to `t_min <= t <= t_max`.
    pub fn within(self, t_min: f64, t_max: f64) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The same ray, seeing only triangles with a bit of `mask`.
    pub fn masked(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|a| self.origin[a] + t * self.direction[a])
    }

    /// Whether it can hit anything: finite, with a direction and a non-empty interval.
    pub fn is_valid(&self) -> bool {
        let finite = self.origin.iter().chain(&self.direction).all(|x| x.is_finite());
        finite && self.direction.iter().any(|&d| d != 0.0) && self.t_min <= self.t_max
    }
}

/// Where a ray meets a triangle, in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HitF64 {
    /// Distance in units of the direction's length.
    pub t: f64,
    /// Weight of the triangle's second corner.
    pub u: f64,
    /// Weight of the triangle's third corner; the first one's is `1 - u - v`.
    pub v: f64,
    /// Which triangle.
    pub tri: TriId,
}

impl HitF64 {
    /// Nearer first, and at equal distance the smaller id: the order in which hits win.
    pub fn wins_over(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.tri < other.tri)
    }
}
