//! The cheapest tree over a lattice, by dynamic programming over its boxes, and the greedy one beside it.

use rdh::kd::Costs;

use super::lattice::{Cell, Lattice};

/// What boxes cost. Multiplied with chances, costs add up over a tree: each box has one optimum, whatever lies above.
pub trait Prices {
    /// The chance that a ray meets the box, or the number of rays that do.
    fn chance(&self, cell: &Cell) -> f64;
    /// How many triangles are in the box.
    fn triangles(&self, cell: &Cell) -> usize;
    /// What a step and a test cost.
    fn costs(&self) -> &Costs;

    /// What all rays pay in the box if it is a leaf.
    fn leaf(&self, cell: &Cell) -> f64 {
        self.chance(cell) * f64::from(self.costs().leaf(self.triangles(cell)))
    }

    /// What all rays pay in the box if it is split, children apart.
    fn step(&self, cell: &Cell) -> f64 {
        self.chance(cell) * f64::from(self.costs().traverse)
    }
}

/// A tree over a lattice.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// A leaf.
    Leaf,
    /// Axis and plane, and what is below and above it.
    Split((usize, usize), Box<[Self; 2]>),
}

/// The cheapest of all trees over the lattice. Takes time with the seventh power of its size.
pub fn optimal(lattice: &Lattice, prices: &dyn Prices) -> Tree {
    let mut known = vec![f64::NAN; lattice.numbers()];
    cheapest(lattice, prices, lattice.whole(), &mut known);
    unfold(lattice, prices, lattice.whole(), &mut known)
}

/// The tree of the builder's rule: at each box the split that were best if its children were leaves; one split that
/// does not pay is borne on the way down, and subtrees that turn out dearer than a leaf become one.
pub fn greedy(lattice: &Lattice, prices: &dyn Prices) -> Tree {
    descend(prices, lattice.whole(), 0).0
}

impl Tree {
    /// What all rays pay in it.
    pub fn cost(&self, prices: &dyn Prices, cell: Cell) -> f64 {
        match self {
            Self::Leaf => prices.leaf(&cell),
            Self::Split(at, children) => {
                let [left, right] = cell.halves(*at);
                prices.step(&cell) + children[0].cost(prices, left) + children[1].cost(prices, right)
            }
        }
    }

    /// The nodes that all rays visit, and the triangles in the leaves among them.
    pub fn steps_and_tests(&self, prices: &dyn Prices, cell: Cell) -> [f64; 2] {
        let visits = prices.chance(&cell);
        match self {
            Self::Leaf => [visits, visits * prices.triangles(&cell) as f64],
            Self::Split(at, children) => {
                let [left, right] = cell.halves(*at);
                let [a, b] = [children[0].steps_and_tests(prices, left), children[1].steps_and_tests(prices, right)];
                [visits + a[0] + b[0], a[1] + b[1]]
            }
        }
    }
}

fn cheapest(lattice: &Lattice, prices: &dyn Prices, cell: Cell, known: &mut [f64]) -> f64 {
    let number = lattice.number(&cell);
    if known[number].is_nan() {
        let step = prices.step(&cell);
        let mut best = prices.leaf(&cell);
        // A box that nothing meets, or that holds nothing, needs no search.
        if best > 0.0 {
            for at in cell.splits() {
                best = best.min(step + both(lattice, prices, cell, at, known));
            }
        }
        known[number] = best;
    }
    known[number]
}

fn both(lattice: &Lattice, prices: &dyn Prices, cell: Cell, at: (usize, usize), known: &mut [f64]) -> f64 {
    let [left, right] = cell.halves(at);
    cheapest(lattice, prices, left, known) + cheapest(lattice, prices, right, known)
}

/// The first split that costs what the box does.
fn unfold(lattice: &Lattice, prices: &dyn Prices, cell: Cell, known: &mut [f64]) -> Tree {
    let cost = cheapest(lattice, prices, cell, known);
    if cost == prices.leaf(&cell) {
        return Tree::Leaf;
    }
    let step = prices.step(&cell);
    let found = cell.splits().find(|&at| step + both(lattice, prices, cell, at, known) == cost);
    let Some(at) = found else { return Tree::Leaf };
    Tree::Split(at, Box::new(cell.halves(at).map(|half| unfold(lattice, prices, half, known))))
}

fn descend(prices: &dyn Prices, cell: Cell, failures: u32) -> (Tree, f64) {
    let as_leaf = (Tree::Leaf, prices.leaf(&cell));
    let priced = cell.splits().map(|at| (at, expected(prices, cell, at)));
    let Some((at, expected)) = priced.min_by(|a, b| a.1.total_cmp(&b.1)) else { return as_leaf };
    let failures = failures + u32::from(expected >= as_leaf.1);
    let one_test = prices.costs().is_one_test(prices.triangles(&cell));
    if failures > 1 || (expected >= as_leaf.1 && one_test) {
        return as_leaf;
    }
    let [(left, l), (right, r)] = cell.halves(at).map(|half| descend(prices, half, failures));
    let cost = prices.step(&cell) + l + r;
    if cost < as_leaf.1 { (Tree::Split(at, Box::new([left, right])), cost) } else { as_leaf }
}

/// What the builder expects of a split: equation (1), with the bonus for empty space.
fn expected(prices: &dyn Prices, cell: Cell, at: (usize, usize)) -> f64 {
    let costs = prices.costs();
    let one_test = costs.is_one_test(prices.triangles(&cell));
    let halves = cell.halves(at);
    let child = |half: &Cell| {
        let n = prices.triangles(half);
        let cost = if one_test { costs.leaf(n) } else { costs.child(n as u32) };
        prices.chance(half) * f64::from(cost)
    };
    let cost = prices.step(&cell) + child(&halves[0]) + child(&halves[1]);
    let empty = !one_test && halves.iter().any(|half| prices.triangles(half) == 0);
    if empty { cost * (1.0 - f64::from(costs.empty_bonus)) } else { cost }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::kd::LeafWidth;

    /// Points in boxes of the lattice as triangles, areas as chances.
    struct Points(Vec<[usize; 3]>, Costs);

    impl Prices for Points {
        fn chance(&self, cell: &Cell) -> f64 {
            let [x, y, z] = [0, 1, 2].map(|axis| (cell.high[axis] - cell.low[axis]) as f64);
            x * y + y * z + z * x
        }
        fn triangles(&self, cell: &Cell) -> usize {
            let within = |p: &&[usize; 3]| (0..3).all(|a| cell.low[a] <= p[a] && p[a] < cell.high[a]);
            self.0.iter().filter(within).count()
        }
        fn costs(&self) -> &Costs {
            &self.1
        }
    }

    fn scattered(n: usize, sides: [usize; 3], leaf: LeafWidth) -> Points {
        let at = |i: usize| [i * 7 % sides[0], i * 5 % 11 % sides[1], i * i % sides[2]];
        Points((0..n).map(at).collect(), Costs::of(leaf))
    }

    /// Every tree, without remembering any box.
    fn exhaustive(prices: &dyn Prices, cell: Cell) -> f64 {
        let below = cell.splits().map(|at| {
            let [left, right] = cell.halves(at);
            prices.step(&cell) + exhaustive(prices, left) + exhaustive(prices, right)
        });
        below.fold(prices.leaf(&cell), f64::min)
    }

    #[test]
    fn the_optimum_is_the_best_of_all_trees() {
        let lattice = Lattice::even([3, 2, 2]);
        for (n, leaf) in [(0, LeafWidth::One), (1, LeafWidth::One), (9, LeafWidth::One), (40, LeafWidth::Eight)] {
            let points = scattered(n, [3, 2, 2], leaf);
            let best = optimal(&lattice, &points).cost(&points, lattice.whole());
            assert_eq!(best, exhaustive(&points, lattice.whole()), "{n} points");
        }
    }

    #[test]
    fn greed_is_never_cheaper_and_sometimes_dearer() {
        let lattice = Lattice::even([5, 4, 6]);
        let mut dearer = 0;
        for n in [1, 5, 20, 60, 200] {
            for leaf in [LeafWidth::One, LeafWidth::Eight] {
                let points = scattered(n, [5, 4, 6], leaf);
                let [best, greedy] = [optimal(&lattice, &points), greedy(&lattice, &points)]
                    .map(|tree| tree.cost(&points, lattice.whole()));
                assert!(best <= greedy + 1e-9, "{n} points");
                dearer += u32::from(best < 0.999 * greedy);
            }
        }
        assert!(dearer > 0, "a greedy search that is always optimal would make the experiment pointless");
    }
}
