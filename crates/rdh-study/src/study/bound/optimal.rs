//! The cheapest tree over a lattice, by dynamic programming over its boxes, and the greedy one beside it.

use super::{Cell, Lattice};

/// What boxes cost. Multiplied with chances, costs add up over a tree: each box has one optimum, whatever lies above.
pub trait Prices {
    /// The chance that a ray meets the box, or the number of rays that do.
    fn chance(&self, cell: &Cell) -> f64;
    /// What a ray pays in the box if it is a leaf.
    fn leaf(&self, cell: &Cell) -> f64;
    /// What a ray pays in the box if it is split, children apart.
    fn traverse(&self) -> f64;
}

/// The cost of the cheapest of all trees over the lattice. Takes time with the seventh power of its size.
pub fn optimal(lattice: Lattice, prices: &dyn Prices) -> f64 {
    let mut known = vec![f64::NAN; lattice.numbers()];
    cheapest(lattice, prices, &lattice.whole(), &mut known)
}

/// The cost of the tree of the greedy choice: at each box the split that were best if its children were leaves.
pub fn greedy(lattice: Lattice, prices: &dyn Prices) -> f64 {
    descend(prices, &lattice.whole())
}

fn cheapest(lattice: Lattice, prices: &dyn Prices, cell: &Cell, known: &mut [f64]) -> f64 {
    let number = lattice.number(cell);
    if known[number].is_nan() {
        let above = prices.chance(cell) * prices.traverse();
        let mut best = as_leaf(prices, cell);
        for (left, right) in cell.splits() {
            let below = cheapest(lattice, prices, &left, known) + cheapest(lattice, prices, &right, known);
            best = best.min(above + below);
        }
        known[number] = best;
    }
    known[number]
}

fn descend(prices: &dyn Prices, cell: &Cell) -> f64 {
    let above = prices.chance(cell) * prices.traverse();
    let price = |(left, right): &(Cell, Cell)| above + as_leaf(prices, left) + as_leaf(prices, right);
    let best = cell.splits().min_by(|a, b| price(a).total_cmp(&price(b)));
    match best.filter(|halves| price(halves) < as_leaf(prices, cell)) {
        Some((left, right)) => above + descend(prices, &left) + descend(prices, &right),
        None => as_leaf(prices, cell),
    }
}

fn as_leaf(prices: &dyn Prices, cell: &Cell) -> f64 {
    prices.chance(cell) * prices.leaf(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points in cells of the lattice as objects, areas as chances.
    struct Points(Vec<[usize; 3]>);

    impl Prices for Points {
        fn chance(&self, cell: &Cell) -> f64 {
            let [x, y, z] = [0, 1, 2].map(|axis| (cell.high[axis] - cell.low[axis]) as f64);
            x * y + y * z + z * x
        }
        fn leaf(&self, cell: &Cell) -> f64 {
            let within = |p: &&[usize; 3]| (0..3).all(|a| cell.low[a] <= p[a] && p[a] < cell.high[a]);
            1.5 * self.0.iter().filter(within).count() as f64
        }
        fn traverse(&self) -> f64 {
            1.0
        }
    }

    fn scattered(n: usize, lattice: Lattice) -> Points {
        let at = |i: usize| [i * 7 % lattice.0[0], i * 5 % 11 % lattice.0[1], i * i % lattice.0[2]];
        Points((0..n).map(at).collect())
    }

    /// Every tree, without remembering any box.
    fn exhaustive(prices: &dyn Prices, cell: &Cell) -> f64 {
        let above = prices.chance(cell) * prices.traverse();
        let below = cell.splits().map(|(l, r)| above + exhaustive(prices, &l) + exhaustive(prices, &r));
        below.fold(as_leaf(prices, cell), f64::min)
    }

    #[test]
    fn the_optimum_is_the_best_of_all_trees() {
        for n in [0, 1, 3, 9, 20] {
            let lattice = Lattice([3, 2, 2]);
            let points = scattered(n, lattice);
            assert_eq!(optimal(lattice, &points), exhaustive(&points, &lattice.whole()), "{n} points");
        }
    }

    #[test]
    fn greed_is_never_cheaper() {
        for n in [1, 5, 20, 60] {
            let lattice = Lattice([5, 4, 6]);
            let points = scattered(n, lattice);
            assert!(optimal(lattice, &points) <= greedy(lattice, &points) + 1e-9, "{n} points");
        }
    }
}
