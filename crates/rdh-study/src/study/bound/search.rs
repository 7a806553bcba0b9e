//! From tree to tree, never to a dearer one: what a greedy search leaves on the table where no optimum can be had.
//!
//! ```text
//! grow the greedy tree
//! while the budget lasts: take the dearest node that has not been looked at
//!     for each of its most promising planes: grow both sides greedily
//!     if the cheapest of these trees is cheaper than what stands there: put it there
//!     look at its children later
//! ```
//! A subtree is only ever replaced by a cheaper one for the rays that it is searched for.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rdh::kd::Costs;

use super::grow::{Cut, Grown, GrownKind, Room, grow, joined};

/// How far the search goes.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Planes tried in full at each node.
    pub planes: usize,
    /// References and rays that all trials together may start from: the budget.
    pub things: usize,
    /// Nodes of more references are left as they are.
    pub largest: usize,
}

impl Default for Effort {
    /// Some ten seconds.
    fn default() -> Self {
        Self { planes: 6, things: 2_000_000, largest: 8_000 }
    }
}

/// The greedy tree by rays, improved.
pub fn search(room: Room, costs: &Costs, effort: &Effort) -> Grown {
    let mut arena = Vec::new();
    let start = grow(&room, costs, 0, 0);
    let root = flatten(start, &mut arena);
    let mut queue = BinaryHeap::from([Waiting { cost: arena[root].cost, node: root, depth: 0, room }]);
    let mut spent = 0;
    while spent < effort.things
        && let Some(next) = queue.pop()
    {
        if next.room.parts.len() <= effort.largest {
            spent += improve(&next, costs, effort, &mut arena);
        }
        if let Kind::Split(cut, children) = arena[next.node].kind {
            for (node, room) in children.into_iter().zip(next.room.split(&cut)) {
                if arena[node].is_split() {
                    queue.push(Waiting { cost: arena[node].cost, node, depth: next.depth + 1, room });
                }
            }
        }
    }
    unflatten(root, &arena)
}

/// Tries some planes in full; returns what that took of the budget.
fn improve(at: &Waiting, costs: &Costs, effort: &Effort, arena: &mut Vec<Node>) -> usize {
    let (room, standing) = (&at.room, arena[at.node].cost);
    let mut best: Option<Grown> = None;
    let cuts = room.cuts(costs, effort.planes);
    for (cut, _) in &cuts {
        let sides = room.split(cut).map(|side| grow(&side, costs, 0, at.depth + 1));
        let trial = joined(room, costs, *cut, sides);
        if trial.cost < best.as_ref().map_or(standing, |b| b.cost) {
            best = Some(trial);
        }
    }
    if let Some(best) = best {
        let root = flatten(best, arena);
        arena[at.node] = arena[root];
    }
    cuts.len() * (room.parts.len() + room.rays.len())
}

/// A node whose improvement is still to come: the dearest first, then the oldest.
struct Waiting {
    cost: f64,
    node: usize,
    depth: usize,
    room: Room,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

/// A node of the tree while it changes.
#[derive(Clone, Copy, Debug)]
struct Node {
    kind: Kind,
    /// When it was grown: an upper bound since.
    cost: f64,
    /// The rays in it.
    visits: f64,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Leaf(usize),
    Split(Cut, [usize; 2]),
}

impl Node {
    fn is_split(&self) -> bool {
        matches!(self.kind, Kind::Split(..))
    }
}

fn flatten(tree: Grown, arena: &mut Vec<Node>) -> usize {
    let cost = tree.cost;
    let (kind, below) = match tree.kind {
        GrownKind::Leaf(n) => (Kind::Leaf(n), cost),
        GrownKind::Split(cut, sides) => {
            let below = sides[0].cost + sides[1].cost;
            (Kind::Split(cut, (*sides).map(|side| flatten(side, arena))), below)
        }
    };
    arena.push(Node { kind, cost, visits: cost - below });
    arena.len() - 1
}

/// The tree with the costs that it has now.
fn unflatten(node: usize, arena: &[Node]) -> Grown {
    let Node { kind, cost, visits } = arena[node];
    match kind {
        Kind::Leaf(n) => Grown { kind: GrownKind::Leaf(n), cost },
        Kind::Split(cut, children) => {
            let sides = children.map(|child| unflatten(child, arena));
            let cost = visits + sides[0].cost + sides[1].cost;
            Grown { kind: GrownKind::Split(cut, Box::new(sides)), cost }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::grow::pay;
    use super::super::shape::{Part, Segment};
    use super::*;
    use rdh::kd::LeafWidth;
    use rdh::{Mesh, Ray};

    fn room() -> Room {
        let at = |i: u32, k: u32| {
            [(i * 37 % 101) as f32 + k as f32, (i * 59 % 103) as f32, (i * 17 % 71) as f32 + 0.5 * k as f32]
        };
        let positions =
            (0..400).flat_map(|i| [at(i, 0), at(i, 1), [at(i, 0)[0], at(i, 0)[1] + 3.0, at(i, 2)[2]]]).collect();
        let mesh = Mesh::new(positions, (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
        let ray = |i: u32| {
            Ray::new(
                [-5.0, (i * 7 % 103) as f32, (i * 3 % 71) as f32],
                [1.0, 0.1 * (i % 5) as f32, 0.02 * (i % 3) as f32],
            )
        };
        let rays: Vec<Segment> = (0..300).map(|i| Segment::new(&ray(i), 40.0 + (i % 60) as f32)).collect();
        Room::new(Part::all(&mesh), &rays)
    }

    #[test]
    fn a_search_never_ends_dearer_than_it_began_and_here_it_gains() {
        let costs = Costs::of(LeafWidth::One);
        let greedy = grow(&room(), &costs, 0, 0);
        let found = search(room(), &costs, &Effort { planes: 4, things: 50_000, largest: 400 });
        assert!(found.cost < greedy.cost, "{} {}", found.cost, greedy.cost);
        let none = search(room(), &costs, &Effort { things: 0, ..Effort::default() });
        assert_eq!(none.cost, greedy.cost);
    }

    #[test]
    fn what_a_tree_says_it_costs_is_what_its_rays_pay() {
        let (costs, room) = (Costs::of(LeafWidth::Eight), room());
        let effort = Effort { planes: 3, things: 10_000, largest: 200 };
        let (rays, low, high) = (room.rays.clone(), room.low, room.high);
        let found = search(room, &costs, &effort);
        let [cost, steps, tests] = pay(&found, &costs, &rays, low, high);
        assert!((cost - found.cost).abs() < 1e-6 * cost, "{cost} {}", found.cost);
        assert!(steps > 300.0 && tests > 0.0);
    }
}
