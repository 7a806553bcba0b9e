//! A part's rays, window by window: through the tree in tiles where that pays.

use super::choices::{Choices, Next};
use super::{Bundle, Cost, Others, Packed, Space, Tiled};
use crate::geom::Ray;
use crate::simd::Kernels;

/// What becomes of a part.
pub(crate) struct Tiles<K: Kernels, T: Tiled> {
    /// None before the first tile: small batches would take long to make one ready.
    bundle: Option<Bundle<K::Rays, T>>,
    choices: Choices,
    space: Space,
    cost: Cost,
}

impl<K: Kernels, T: Tiled> Tiles<K, T> {
    /// Of so many rays, which are rows of `width` of a picture or have no rows.
    #[inline(always)]
    pub(crate) fn new(tree: &T, count: usize, width: Option<usize>) -> Self {
        let space = tree.space();
        let has_tiles = K::PACKETS && space.scale.factor() == 1.0;
        let choices = Choices::new(count, width, &space.bounds, has_tiles);
        Self { bundle: None, choices, space, cost: Cost::default() }
    }

    /// Casts what makes tiles, until there are enough others or no rays are left.
    #[inline(always)]
    pub(crate) fn cast<C: Packed>(
        &mut self,
        tree: &T,
        rays: &[Ray],
        answers: &mut [C::Output],
        others: &mut Others<'_>,
    ) {
        while !others.are_enough() {
            match self.choices.next(rays) {
                Next::End => return,
                Next::Others(choice) => others.add(choice.rays()),
                // There are none: this spares the program their code.
                Next::Tile(choice) if !K::PACKETS => others.add(choice.rays()),
                Next::Tile(choice) => {
                    if self.bundle.is_none() {
                        self.bundle = Some(Bundle::empty());
                    }
                    let Some(bundle) = &mut self.bundle else { return };
                    if bundle.fill(rays, &choice, &self.space) {
                        if tree.walk::<K, C>(bundle) {
                            bundle.tile.read::<C>(choice.rays(), answers);
                        } else {
                            bundle.tile.read_settled::<C>(choice.rays(), answers, others);
                        }
                        self.choices.has_paid(bundle.effort.has_paid());
                        self.cost.cycles += bundle.effort.cycles();
                    } else if let Some(choice) = self.choices.failed(choice) {
                        others.add(choice.rays());
                    }
                }
            }
        }
    }

    /// So many rays were cast otherwise.
    pub(crate) fn cast_otherwise(&mut self, count: usize) {
        self.cost.others += count;
    }

    /// The first ray that is left, if those from there on are all that are.
    pub(crate) fn rest(&self) -> Option<usize> {
        self.choices.rest()
    }

    /// Whether there are no more rays.
    pub(crate) fn are_done(&self) -> bool {
        self.choices.is_empty()
    }

    /// What it all has cost.
    pub(crate) fn cost(self) -> Cost {
        self.cost
    }
}
