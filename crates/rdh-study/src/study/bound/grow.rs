//! Trees with planes at any triangle's bound: the builder's greedy rule over exactly cut triangles and exactly counted rays.

use rdh::kd::Costs;

use super::shape::{Part, Segment};

/// A box with what is in it.
#[derive(Clone, Debug)]
pub struct Room {
    /// The lower corner.
    pub low: [f64; 3],
    /// The upper corner.
    pub high: [f64; 3],
    /// Its triangles.
    pub parts: Vec<Part>,
    /// Its rays.
    pub rays: Vec<Segment>,
}

/// A plane, and on which side triangles lie that are flat in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The axis.
    pub axis: usize,
    /// Where.
    pub plane: f64,
    /// Whether flat ones lie below.
    pub flat_below: bool,
}

/// A tree, with what its rays pay in it.
#[derive(Clone, Debug)]
pub struct Grown {
    /// Its root.
    pub kind: GrownKind,
    /// What all its rays pay together.
    pub cost: f64,
}

/// A node of a tree.
#[derive(Clone, Debug)]
pub enum GrownKind {
    /// A leaf of so many triangles.
    Leaf(usize),
    /// A split.
    Split(Cut, Box<[Grown; 2]>),
}

/// Planes an axis that are tried in a node, of those at triangles' bounds.
const PLANES: usize = 64;
/// No tree is deeper.
const DEEPEST: usize = 48;

impl Room {
    /// A box around everything, with the rays that meet it.
    pub fn new(parts: Vec<Part>, rays: &[Segment]) -> Self {
        let fold = |start: f64, f: fn(f64, f64) -> f64, of: fn(&Part) -> [f64; 3]| {
            [0, 1, 2].map(|axis| parts.iter().map(|p| of(p)[axis]).fold(start, f))
        };
        let low = fold(f64::INFINITY, f64::min, |p| p.low);
        let high = fold(f64::NEG_INFINITY, f64::max, |p| p.high);
        let within = |ray: &Segment| (0..3).try_fold(*ray, |ray, axis| ray.clip(axis, low[axis], high[axis]));
        let rays = rays.iter().filter_map(within).collect();
        Self { low, high, parts, rays }
    }

    /// Both sides of a plane.
    pub fn split(&self, cut: &Cut) -> [Self; 2] {
        let Cut { axis, plane, flat_below } = *cut;
        let empty = || Self { parts: Vec::new(), rays: Vec::new(), ..*self };
        let mut sides = [empty(), empty()];
        (sides[0].high[axis], sides[1].low[axis]) = (plane, plane);
        for part in &self.parts {
            for (side, half) in sides.iter_mut().zip(part.split(axis, plane, flat_below)) {
                side.parts.extend(half);
            }
        }
        for side in &mut sides {
            let (low, high) = (side.low[axis], side.high[axis]);
            side.rays.extend(self.rays.iter().filter_map(|ray| ray.clip(axis, low, high)));
        }
        sides
    }

    /// What its rays pay if it is a leaf.
    pub fn leaf_cost(&self, costs: &Costs) -> f64 {
        self.rays.len() as f64 * f64::from(costs.leaf(self.parts.len()))
    }

    /// The most promising planes, best first, with what the builder expects of each for a ray in the box.
    pub fn cuts(&self, costs: &Costs, most: usize) -> Vec<(Cut, f64)> {
        let mut cuts: Vec<(Cut, f64)> = (0..3).flat_map(|axis| self.cuts_across(axis, costs)).collect();
        cuts.sort_by(|a, b| a.1.total_cmp(&b.1));
        cuts.truncate(most);
        cuts
    }

    fn cuts_across(&self, axis: usize, costs: &Costs) -> Vec<(Cut, f64)> {
        let ascending = |of: &dyn Fn(&Part) -> Option<f64>| {
            let mut all: Vec<f64> = self.parts.iter().filter_map(of).collect();
            all.sort_unstable_by(f64::total_cmp);
            all
        };
        let lows = ascending(&|p| Some(p.low[axis]));
        let highs = ascending(&|p| Some(p.high[axis]));
        let flats = ascending(&|p| (p.low[axis] == p.high[axis]).then_some(p.low[axis]));
        let entered = Entered::new(&self.rays, axis);
        let expected = |plane: f64| -> (Cut, f64) {
            let at = |sorted: &[f64]| sorted.partition_point(|x| *x <= plane) - sorted.partition_point(|x| *x < plane);
            let (below, above) =
                (lows.partition_point(|x| *x < plane), highs.len() - highs.partition_point(|x| *x <= plane));
            let chances = entered.chances(plane);
            let flat = at(&flats);
            let on = |flat_below: bool| {
                let (n, m) = if flat_below { (below + flat, above) } else { (below, above + flat) };
                (Cut { axis, plane, flat_below }, self.expected(costs, chances, [n, m]))
            };
            let (a, b) = (on(false), on(true));
            if b.1 < a.1 { b } else { a }
        };
        let (low, high) = (self.low[axis], self.high[axis]);
        candidates(&lows, &highs).into_iter().filter(|&p| low < p && p < high).map(expected).collect()
    }

    /// Equation (1), with the bonus for empty space, as the builder reckons it.
    fn expected(&self, costs: &Costs, chances: [f64; 2], counts: [usize; 2]) -> f64 {
        let one_test = costs.is_one_test(self.parts.len());
        let child = |n: usize| f64::from(if one_test { costs.leaf(n) } else { costs.child(n as u32) });
        let cost = f64::from(costs.traverse) + chances[0] * child(counts[0]) + chances[1] * child(counts[1]);
        let empty = !one_test && counts.contains(&0);
        if empty { cost * (1.0 - f64::from(costs.empty_bonus)) } else { cost }
    }
}

/// The builder's rule: the best plane; one that does not pay is borne on the way down; what turns out dearer than a leaf
/// becomes one.
pub fn grow(room: &Room, costs: &Costs, failures: u32, depth: usize) -> Grown {
    let n = room.parts.len();
    let leaf = Grown { kind: GrownKind::Leaf(n), cost: room.leaf_cost(costs) };
    let expected_leaf = f64::from(costs.leaf(n));
    // Where no ray comes, nothing can be cheaper.
    if room.rays.is_empty() || depth >= DEEPEST || expected_leaf <= f64::from(costs.traverse) {
        return leaf;
    }
    let Some(&(cut, expected)) = room.cuts(costs, 1).first() else { return leaf };
    let pays = expected < expected_leaf;
    let failures = failures + u32::from(!pays);
    if failures > 1 || (!pays && costs.is_one_test(n)) {
        return leaf;
    }
    let sides = room.split(&cut).map(|side| grow(&side, costs, failures, depth + 1));
    let grown = joined(room, costs, cut, sides);
    if grown.cost < leaf.cost { grown } else { leaf }
}

/// A node over two trees.
pub(super) fn joined(room: &Room, costs: &Costs, cut: Cut, sides: [Grown; 2]) -> Grown {
    let cost = room.rays.len() as f64 * f64::from(costs.traverse) + sides[0].cost + sides[1].cost;
    Grown { kind: GrownKind::Split(cut, Box::new(sides)), cost }
}

/// What other rays pay in a tree: cost, steps and tests, all rays together.
pub fn pay(tree: &Grown, costs: &Costs, rays: &[Segment], low: [f64; 3], high: [f64; 3]) -> [f64; 3] {
    let visits = rays.len() as f64;
    match &tree.kind {
        GrownKind::Leaf(n) => [visits * f64::from(costs.leaf(*n)), visits, visits * *n as f64],
        GrownKind::Split(cut, sides) => {
            let (mut middle_high, mut middle_low) = (high, low);
            (middle_high[cut.axis], middle_low[cut.axis]) = (cut.plane, cut.plane);
            let side = |low: [f64; 3], high: [f64; 3], tree: &Grown| {
                let inside = |ray: &Segment| ray.clip(cut.axis, low[cut.axis], high[cut.axis]);
                pay(tree, costs, &rays.iter().filter_map(inside).collect::<Vec<_>>(), low, high)
            };
            let (a, b) = (side(low, middle_high, &sides[0]), side(middle_low, high, &sides[1]));
            let here = [visits * f64::from(costs.traverse), visits, 0.0];
            [0, 1, 2].map(|i| here[i] + a[i] + b[i])
        }
    }
}

/// Where rays are along an axis, sorted.
struct Entered {
    lows: Vec<f64>,
    highs: Vec<f64>,
}

impl Entered {
    fn new(rays: &[Segment], axis: usize) -> Self {
        let (mut lows, mut highs): (Vec<f64>, Vec<f64>) = rays.iter().map(|ray| ray.extent(axis)).unzip();
        lows.sort_unstable_by(f64::total_cmp);
        highs.sort_unstable_by(f64::total_cmp);
        Self { lows, highs }
    }

    /// Equation (2).
    fn chances(&self, plane: f64) -> [f64; 2] {
        let n = self.lows.len().max(1) as f64;
        let below = self.lows.partition_point(|x| *x <= plane) as f64;
        let above = (self.highs.len() - self.highs.partition_point(|x| *x < plane)) as f64;
        [below / n, above / n]
    }
}

/// The bounds in order, each once; of many, some at even ranks.
fn candidates(lows: &[f64], highs: &[f64]) -> Vec<f64> {
    let mut all = [lows, highs].concat();
    all.sort_unstable_by(f64::total_cmp);
    all.dedup();
    let n = all.len();
    if n <= PLANES {
        return all;
    }
    (0..PLANES).map(|i| all[i * (n - 1) / (PLANES - 1)]).collect()
}
