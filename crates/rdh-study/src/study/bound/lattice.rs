//! A lattice of planes, and the boxes between them.

/// The number of intervals between neighbouring planes, along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice(pub [usize; 3]);

/// A box of the lattice: along each axis the indices of its two planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The lower planes.
    pub low: [usize; 3],
    /// The upper planes, each above the lower one.
    pub high: [usize; 3],
}

impl Lattice {
    /// The whole lattice as one box.
    pub fn whole(self) -> Cell {
        Cell { low: [0; 3], high: self.0 }
    }

    /// More than the number of any box.
    pub(super) fn numbers(self) -> usize {
        self.0.iter().map(|n| (n + 1) * (n + 1)).product()
    }

    pub(super) fn number(self, cell: &Cell) -> usize {
        (0..3).fold(0, |sum, axis| {
            let planes = self.0[axis] + 1;
            (sum * planes + cell.low[axis]) * planes + cell.high[axis]
        })
    }
}

impl Cell {
    /// Both halves at every plane that lies within, axis by axis.
    pub fn splits(self) -> impl Iterator<Item = (Self, Self)> {
        (0..3).flat_map(move |axis| (self.low[axis] + 1..self.high[axis]).map(move |plane| self.at(axis, plane)))
    }

    fn at(self, axis: usize, plane: usize) -> (Self, Self) {
        let (mut left, mut right) = (self, self);
        left.high[axis] = plane;
        right.low[axis] = plane;
        (left, right)
    }
}
