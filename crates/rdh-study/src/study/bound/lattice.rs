//! A lattice of planes, and the boxes between them.

use super::shape::Part;

/// Planes along x, y and z: ascending, at least two each.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    planes: [Vec<f64>; 3],
}

/// A box of a lattice: along each axis the indices of its two planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The lower planes.
    pub low: [usize; 3],
    /// The upper planes, each above the lower one.
    pub high: [usize; 3],
}

impl Lattice {
    /// At most `most` + 1 planes an axis: the scene's bounds, the `preferred` planes (axis and place) in their order, and
    /// then triangles' bounds at even ranks. Nothing for scenes that are flat along an axis.
    pub fn over(parts: &[Part], preferred: &[(usize, f64)], most: usize) -> Option<Self> {
        let planes = [0, 1, 2].map(|axis| {
            let mut bounds: Vec<f64> = parts.iter().flat_map(|p| [p.low[axis], p.high[axis]]).collect();
            sort(&mut bounds);
            let ends = [bounds.first(), bounds.last()].into_iter().flatten().copied();
            let chosen = preferred.iter().filter(|p| p.0 == axis).map(|p| p.1);
            let mut planes: Vec<f64> = Vec::new();
            for plane in ends.chain(chosen).chain(thinned(&bounds, most)) {
                if planes.len() <= most && !planes.contains(&plane) {
                    planes.push(plane);
                }
            }
            sort(&mut planes);
            planes
        });
        planes.iter().all(|p| p.len() >= 2).then_some(Self { planes })
    }

    /// Even intervals of length 1.
    #[cfg(test)]
    pub(super) fn even(intervals: [usize; 3]) -> Self {
        Self { planes: intervals.map(|n| (0..=n).map(|i| i as f64).collect()) }
    }

    /// The planes across an axis.
    pub fn planes(&self, axis: usize) -> &[f64] {
        &self.planes[axis]
    }

    /// The whole lattice as one box.
    pub fn whole(&self) -> Cell {
        Cell { low: [0; 3], high: [0, 1, 2].map(|axis| self.planes[axis].len() - 1) }
    }

    /// The surface area of a box, halved.
    pub fn area(&self, cell: &Cell) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|a| self.planes[a][cell.high[a]] - self.planes[a][cell.low[a]]);
        x * y + y * z + z * x
    }

    /// More than the number of any box.
    pub(super) fn numbers(&self) -> usize {
        self.planes.iter().map(|p| p.len() * p.len()).product()
    }

    pub(super) fn number(&self, cell: &Cell) -> usize {
        (0..3).fold(0, |sum, axis| {
            let n = self.planes[axis].len();
            (sum * n + cell.low[axis]) * n + cell.high[axis]
        })
    }
}

impl Cell {
    /// Every axis and plane that lies within, axis by axis.
    pub fn splits(self) -> impl Iterator<Item = (usize, usize)> {
        (0..3).flat_map(move |axis| (self.low[axis] + 1..self.high[axis]).map(move |plane| (axis, plane)))
    }

    /// Both halves.
    pub fn halves(self, (axis, plane): (usize, usize)) -> [Self; 2] {
        let (mut left, mut right) = (self, self);
        left.high[axis] = plane;
        right.low[axis] = plane;
        [left, right]
    }
}

/// Ascending, each once.
fn sort(values: &mut Vec<f64>) {
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
}

/// `most` + 1 of the values at most, first and last included.
fn thinned(values: &[f64], most: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    if last <= most || most == 0 {
        return values.to_vec();
    }
    (0..=most).map(|i| values[i * last / most]).collect()
}
