//! Sampled rays in the picture of a side: where they go, and how close together.

use super::cell::Cell;

/// Places of sampled rays in one picture, with their weights.
#[derive(Debug, Clone, Default)]
pub(super) struct Places(pub(super) Vec<Place>);

/// Where a sampled ray goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) at: [f32; 2],
    /// How many rays it stands for.
    pub(super) weight: f32,
}

impl Places {
    /// The box of all.
    pub(super) fn window(&self) -> Cell {
        self.0.iter().fold(Cell::EMPTY, |window, place| window.with(place.at))
    }

    /// Those whose footprint meets a cell.
    pub(super) fn among(&self, cell: &Cell, foot: f32) -> Self {
        let half = 0.5 * foot;
        let near = |p: &&Place| (0..2).all(|a| cell.low[a] - half <= p.at[a] && p.at[a] <= cell.high[a] + half);
        Self(self.0.iter().filter(near).copied().collect())
    }

    /// Their weight.
    pub(super) fn weight(&self) -> f32 {
        self.0.iter().map(|p| p.weight).sum()
    }
}
