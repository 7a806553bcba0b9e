//! Cells of a picture, and triangles against them: conservatively, by the linear forms' ends at the corners.

use crate::simd::Sight;

/// A rectangle of a picture, closed on all sides: `[u, v]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
}

impl Cell {
    /// The whole picture.
    pub(super) const WHOLE: Self = Self { low: [-1.0; 2], high: [1.0; 2] };

    /// Holds nothing.
    pub(super) const EMPTY: Self = Self { low: [f32::INFINITY; 2], high: [f32::NEG_INFINITY; 2] };

    /// The two parts at a line.
    pub(super) fn split(&self, axis: usize, at: f32) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        low.high[axis] = at;
        high.low[axis] = at;
        [low, high]
    }

    /// Whether both have a point in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..2).all(|a| self.low[a] <= other.high[a] && other.low[a] <= self.high[a])
    }

    /// Whether the other lies in this one.
    pub(super) fn holds(&self, other: &Self) -> bool {
        (0..2).all(|a| self.low[a] <= other.low[a] && other.high[a] <= self.high[a])
    }

    /// Whether a place lies in it.
    #[inline(always)]
    pub(super) fn has(&self, u: f32, v: f32) -> bool {
        self.low[0] <= u && u <= self.high[0] && self.low[1] <= v && v <= self.high[1]
    }

    /// This cell, grown to hold a place.
    pub(super) fn with(self, place: [f32; 2]) -> Self {
        Self { low: [0, 1].map(|a| self.low[a].min(place[a])), high: [0, 1].map(|a| self.high[a].max(place[a])) }
    }

    /// The smallest and the largest value of a linear form in the cell.
    fn range(&self, form: &[f32; 3]) -> (f64, f64) {
        let [a, b, c] = form.map(f64::from);
        let ends = |f: f64, axis: usize| {
            let (x, y) = (f * f64::from(self.low[axis]), f * f64::from(self.high[axis]));
            (x.min(y), x.max(y))
        };
        let ((u0, u1), (v0, v1)) = (ends(a, 0), ends(b, 1));
        (u0 + v0 + c, u1 + v1 + c)
    }

    /// Whether a ray in the cell may hit the triangle, by its edges.
    pub(super) fn may_see(&self, sight: &Sight) -> bool {
        // Of −1, that nothing depends on how the form is rounded.
        sight.edges.iter().all(|edge| self.range(edge).1 >= -1.5)
    }

    /// If each ray in the cell surely hits the triangle: how near at least.
    pub(super) fn covered_by(&self, sight: &Sight) -> Option<f64> {
        // Twice the margin, so that it is certain for rays too, whose forms are rounded.
        let covers = sight.edges.iter().all(|edge| self.range(edge).0 > 2.0);
        covers.then(|| self.nearness(sight).0)
    }

    /// How near hits in the cell are, at least and at most.
    pub(super) fn nearness(&self, sight: &Sight) -> (f64, f64) {
        let (low, high) = self.range(&sight.nearness);
        let slack = |x: f64| 2.0 * (x.abs() * f64::from(sight.slack[0]) + f64::from(sight.slack[1]));
        (low - slack(low), (high + slack(high)).min(f64::from(sight.near)))
    }
}
