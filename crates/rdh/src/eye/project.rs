//! A triangle in the picture of a side: linear forms with margins, and a box.
//!
//! Points are given relative to the eye along the side's axes, z to the front, in f64. A ray through the eye is `(u, v)`: the points
//! `z · (u, v, 1)`. With `x_i = X_i − u Z_i` and `y_i = Y_i − v Z_i` the edge function of two corners is linear in `u` and `v`:
//! ```text
//! E_ab(u, v) = x_a y_b − y_a x_b = (u, v, 1) · (P_a × P_b)        Σ E_k = (u, v, 1) · n        Σ E_k Z_k = det = P_0 · (P_2 × P_1)
//! ```
//! so that 1/z = Σ E_k / det is linear too. This holds wherever the corners lie: nothing needs to be cut at a near plane.
//!
//! THE triangle test finds the same functions of corners that rounding has moved, `|x'_i − x_i| ≤ δ_i`, likewise `y`, with exact signs:
//! a ray that starts at the eye has δ_i = 2⁻²⁴ (|Z_i| + |x_i|), since the differences to the eye are the very same f32; one that only
//! passes by it has the tolerance's length, whatever the corner. Hence
//! ```text
//! |E'_ab − E_ab| ≤ δ_a (|x_b| + |y_b|) + δ_b (|x_a| + |y_a|) + 2 δ_a δ_b  =: m
//! ```
//! and a hit's depth is the mean of the corners' with the weights E'. What follows from it: an accepted ray lies in the box, and has
//! E ≥ −m if `det > Σ m_k |Z_k|` (else all E' could be negative); a ray with E > m surely crosses; and the reciprocal of the hit's depth lies
//! in `(Σ E ± Σ m) / (det ∓ Σ m_k |Z_k|)`. To m is added what f32 rounds of the forms, 6 · 2⁻²⁴ of their coefficients' sizes.

use crate::simd::Sight;

/// A point relative to the eye, z to the front.
pub(super) type Point = [f64; 3];

/// The largest relative error of one rounding to f32.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// What products of f32 may lose by underflow.
const UNDERFLOW: f64 = 1e-44;

/// How far the rays pass by the eye, with what THE triangle test rounds for such rays; all 0 for rays that start at the eye.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Tolerance {
    /// Across the ray.
    pub(super) across: f64,
    /// Along the ray: hits so far behind the eye count too.
    pub(super) along: f64,
}

/// A triangle in a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projected {
    pub(super) sight: Sight,
    /// The box of all rays that may hit it: lower and upper u and v.
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
}

/// The triangle as the side sees it, if it does.
pub(super) fn project(p: &[Point; 3], id: u32, tolerance: &Tolerance) -> Option<Projected> {
    let outline = Outline::of(p, tolerance)?;
    let forms = Forms::of(p, tolerance).and_then(|forms| forms.sight(&outline, id));
    let sight = forms.unwrap_or_else(|| outline.sight(id));
    Some(Projected { sight, low: outline.low, high: outline.high })
}

fn size(p: &Point) -> f64 {
    p[0].abs() + p[1].abs() + p[2].abs()
}

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Where the triangle lies in the picture.
struct Outline {
    low: [f32; 2],
    high: [f32; 2],
    /// No hit is nearer; infinite if it may be at the eye.
    near: f32,
}

impl Outline {
    /// What lies within the picture, −1 to 1, of the triangle; nothing if it is outside.
    fn of(p: &[Point; 3], tolerance: &Tolerance) -> Option<Self> {
        let largest = p.iter().map(size).fold(0.0, f64::max);
        let across = 2.0 * UNIT * largest + tolerance.across + UNDERFLOW;
        // More than all roundings of the cuts.
        let pad = across + 2.0 * tolerance.along + largest * 1e-12;
        let clipped = Polygon::of(p).clipped(tolerance.along + largest * 1e-12, pad)?;
        let points = clipped.points();
        let nearest = points.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
        if nearest <= 16.0 * pad {
            return Some(Self { low: [-1.0; 2], high: [1.0; 2], near: f32::INFINITY });
        }
        let pad = 1.01 * pad / nearest + 1e-9;
        let end = |axis: usize, sign: f64| {
            let along = points.iter().map(|p| sign * p[axis] / p[2]).fold(f64::NEG_INFINITY, f64::max);
            sign * (along + pad).min(1.0)
        };
        let low = [0, 1].map(|a| (end(a, -1.0) as f32).next_down());
        let high = [0, 1].map(|a| (end(a, 1.0) as f32).next_up());
        Some(Self { low, high, near: ((1.0 + 1e-6) / nearest) as f32 })
    }

    /// A triangle of which no more than the box is known: never certain, never placed in depth. Of the box's four sides three fit in.
    fn sight(&self, id: u32) -> Sight {
        const STEEP: f32 = (1 << 20) as f32;
        let edges = [
            [STEEP, 0.0, -STEEP * self.low[0]],
            [-STEEP, 0.0, STEEP * self.high[0]],
            [0.0, STEEP, -STEEP * self.low[1]],
        ];
        Sight { edges, nearness: [0.0; 3], slack: [0.0, f32::INFINITY], near: self.near, id }
    }
}

/// A convex polygon while it is cut: a triangle and five cuts make eight corners at most, and roundings a few more.
struct Polygon {
    points: [Point; 12],
    len: usize,
}

impl Polygon {
    fn of(p: &[Point; 3]) -> Self {
        let mut points = [[0.0; 3]; 12];
        points[..3].copy_from_slice(p);
        Self { points, len: 3 }
    }

    fn points(&self) -> &[Point] {
        &self.points[..self.len]
    }

    /// What is in front of the eye, from so far behind it on, and in the picture grown by a pad.
    fn clipped(mut self, behind: f64, pad: f64) -> Option<Self> {
        let planes: [[f64; 4]; 5] = [
            [0.0, 0.0, 1.0, behind],
            [-1.0, 0.0, 1.0, pad],
            [1.0, 0.0, 1.0, pad],
            [0.0, -1.0, 1.0, pad],
            [0.0, 1.0, 1.0, pad],
        ];
        for plane in &planes {
            self = self.cut(plane)?;
        }
        Some(self)
    }

    fn cut(self, [a, b, c, d]: &[f64; 4]) -> Option<Self> {
        let above = |p: &Point| a * p[0] + b * p[1] + c * p[2] + d;
        let inside = self.points().iter().filter(|p| above(p) >= 0.0).count();
        if inside == self.len {
            return Some(self);
        }
        if inside == 0 {
            return None;
        }
        let mut cut = Self { points: [[0.0; 3]; 12], len: 0 };
        for i in 0..self.len {
            let (p, q) = (self.points[i], self.points[(i + 1) % self.len]);
            let (f, g) = (above(&p), above(&q));
            if f >= 0.0 {
                cut.push(p);
            }
            if (f >= 0.0) != (g >= 0.0) {
                let t = f / (f - g);
                cut.push([0, 1, 2].map(|k| p[k] + t * (q[k] - p[k])));
            }
        }
        Some(cut)
    }

    /// Rounding may make more crossings than a convex polygon has: a triangle whose corners lie in a plane but for roundings.
    fn push(&mut self, p: Point) {
        if self.len < self.points.len() {
            self.points[self.len] = p;
            self.len += 1;
        }
    }
}

/// The edge functions with their margins.
struct Forms {
    edges: [Point; 3],
    margins: [f64; 3],
    determinant: f64,
    /// Σ m_k |Z_k|.
    off: f64,
}

impl Forms {
    /// None if it is not sure to which side the triangle shows.
    fn of(p: &[Point; 3], tolerance: &Tolerance) -> Option<Self> {
        let [p0, p1, p2] = p;
        let edges = [cross(p2, p1), cross(p0, p2), cross(p1, p0)];
        let margin = Margin::of(p, tolerance);
        let pairs = [(2, 1), (0, 2), (1, 0)];
        let margins = [0, 1, 2].map(|k| margin.of_edge(pairs[k]) + 6.0 * UNIT * size(&edges[k]));
        let determinant = p0[0] * edges[0][0] + p0[1] * edges[0][1] + p0[2] * edges[0][2];
        let off: f64 = (0..3).map(|k| margins[k] * p[k][2].abs()).sum();
        let sum: f64 = edges.iter().map(size).sum::<f64>() + margins.iter().sum::<f64>();
        let sure = determinant.abs() > 1.05 * (off + tolerance.along * sum);
        sure.then_some(Self { edges, margins, determinant, off })
    }

    /// In f32, unless that can't hold it.
    fn sight(&self, outline: &Outline, id: u32) -> Option<Sight> {
        let sign = self.determinant.signum();
        let edges = [0, 1, 2].map(|k| self.edges[k].map(|x| (sign * x / self.margins[k]) as f32));
        let sum = [0, 1, 2].map(|a| self.edges.iter().map(|e| e[a]).sum::<f64>());
        let nearness = sum.map(|x| x / self.determinant);
        let sure = self.determinant.abs() - self.off;
        let relative = 2.1 * self.off / sure + 8.0 * UNIT;
        let beside = 1.1 * self.margins.iter().sum::<f64>() / sure + 7.0 * UNIT * size(&nearness) + 1e-37;
        let (nearness, slack) = (nearness.map(|x| x as f32), [relative as f32, beside as f32]);
        let fits = |x: &f32| x.abs() < 1e36;
        let all_fit = edges.iter().flatten().chain(&nearness).chain(&slack).all(fits);
        all_fit.then_some(Sight { edges, nearness, slack, near: outline.near, id })
    }
}

/// What the edge functions may be off: the smaller of two bounds.
struct Margin {
    /// Of each corner, for rays anywhere in the picture: |x_i| + |y_i| at most, and δ_i.
    sizes: [f64; 3],
    deltas: [f64; 3],
    /// For rays in the triangle's box: in parts of the depths' product; none unless all corners lie before the eye.
    in_box: Option<f64>,
    depths: [f64; 3],
}

impl Margin {
    fn of(p: &[Point; 3], tolerance: &Tolerance) -> Self {
        let sizes = [0, 1, 2].map(|i| 2.0 * size(&p[i]));
        let deltas = sizes.map(|size| UNIT * size + tolerance.across + UNDERFLOW);
        let depths = [0, 1, 2].map(|i| p[i][2]);
        let nearest = depths.iter().copied().fold(f64::INFINITY, f64::min);
        let in_box = (nearest > 0.0).then(|| {
            let extent = [0, 1].map(|a| {
                let along = p.map(|p| p[a] / p[2]);
                along[0].max(along[1]).max(along[2]) - along[0].min(along[1]).min(along[2])
            });
            let delta = UNIT * (1.0 + extent[0].max(extent[1])) + (tolerance.across + UNDERFLOW) / nearest;
            let pad = 1.1 * delta;
            1.01 * (2.0 * pad * (extent[0] + extent[1] + 2.0 * pad) + 2.0 * pad * pad)
        });
        Self { sizes, deltas, in_box, depths }
    }

    fn of_edge(&self, (a, b): (usize, usize)) -> f64 {
        let (d, s) = (&self.deltas, &self.sizes);
        let anywhere = 1.01 * (d[a] * s[b] + d[b] * s[a] + 2.0 * d[a] * d[b]);
        let in_box = self.in_box.map_or(f64::INFINITY, |part| part * self.depths[a] * self.depths[b]);
        anywhere.min(in_box)
    }
}
