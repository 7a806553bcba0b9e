//! What a part of a batch has cost: in cycles of a CPU with AVX2, about, by what is counted.

use super::Prices;
use crate::probe::Counts;

/// What a part has cost.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cost {
    /// What tiles took.
    pub(crate) cycles: u64,
    /// Rays that were cast otherwise.
    pub(crate) others: usize,
}

/// One ray in so many tells what rays cost that go alone.
const ONE_IN: usize = 16;

impl Cost {
    /// All of it, with what `cast` counts for some of so many rays, by their numbers.
    pub(crate) fn with_others<P: Prices>(self, rays: usize, mut cast: impl FnMut(usize, &mut Counts)) -> u64 {
        let (mut counts, mut few) = (Counts::default(), 0);
        for ray in (0..rays).step_by(ONE_IN).take(self.others) {
            cast(ray, &mut counts);
            few += 1;
        }
        self.cycles + P::alone(few, &counts) * self.others as u64 / few.max(1)
    }
}
