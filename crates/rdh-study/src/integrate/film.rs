//! Film positions: one a pixel for the test rays, others for the training rays.

use super::random::Random;

/// A position on the film, and the random numbers of the path that starts there.
pub(crate) struct FilmSample {
    /// Across, 0 to 1 from the left.
    pub(crate) x: f64,
    /// Down, 0 to 1 from the top.
    pub(crate) y: f64,
    pub(crate) random: Random,
}

/// A film divided into cells, one jittered sample in each, in scan-line order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Film {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) seed: u64,
}

impl Film {
    /// The coarsest film of at least `count` about square cells.
    pub(crate) fn of_about(count: usize, seed: u64) -> Self {
        let columns = (count as f64).sqrt().ceil().max(1.0) as usize;
        Self { columns, rows: count.div_ceil(columns).max(1), seed }
    }

    pub(crate) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// The sample in a cell; it depends on nothing but the film's seed and the cell's index.
    pub(crate) fn sample(&self, index: usize) -> FilmSample {
        let mut random = Random::new(self.seed, index as u64);
        let (column, row) = (index % self.columns, index / self.columns);
        let x = (column as f64 + random.unit()) / self.columns as f64;
        let y = (row as f64 + random.unit()) / self.rows as f64;
        FilmSample { x, y, random }
    }

    /// About `count` of this film's cells, spread evenly and chosen by `seed`: one in each cell of a coarser film.
    /// Ascending, each at most once.
    pub(crate) fn subset(&self, count: usize, seed: u64) -> Vec<usize> {
        let coarse = Self::of_about(count, seed);
        let cell_of = |sample: FilmSample| {
            let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            at(sample.y, self.rows) * self.columns + at(sample.x, self.columns)
        };
        let mut cells: Vec<usize> = (0..coarse.len()).map(|i| cell_of(coarse.sample(i))).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_holds_its_sample() {
        let film = Film { columns: 7, rows: 5, seed: 3 };
        for index in 0..film.len() {
            let sample = film.sample(index);
            assert_eq!((sample.x * 7.0) as usize + 7 * (sample.y * 5.0) as usize, index);
        }
    }

    #[test]
    fn a_subset_has_about_the_size_asked_for_and_no_cell_twice() {
        let film = Film { columns: 64, rows: 64, seed: 3 };
        let subset = film.subset(64, 9);
        assert_eq!(subset.len(), 64);
        assert!(subset.windows(2).all(|w| w[0] < w[1]) && subset[63] < film.len());
        // More than there are: all that were met, each once.
        let all = film.subset(1 << 16, 9);
        assert!(all.len() <= film.len() && all.len() > film.len() * 9 / 10);
        assert!(all.windows(2).all(|w| w[0] < w[1]));
    }
}
