//! Well-formedness of a whole tree, as a list of faults: nothing is taken on trust.

use super::node::{Node, NodeKind};
use super::reference::Reference;
use super::stop::StopRule;
use super::{KdTree, Tally, references};
use crate::clip::{TriangleClipper, split_triangle};
use crate::fault::{Fault, Faults};
use crate::geom::{Aabb, RayFrame, Vec3};
use crate::mesh::Mesh;
use crate::parts::{Part, Place};
use crate::simd::LANES;

impl KdTree {
    /// All faults of the tree over its mesh, at most 100: links, depth, planes inside their cells, ids and copies of triangles, and
    /// that no triangle is missing from a cell it reaches into. O(references · depth).
    pub fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        let mut check = Check::new(self, mesh);
        check.structure();
        if check.faults.is_empty() && check.tally != self.tally {
            check.faults.add(ROOT, format!("the tree is {:?}, not {:?}", check.tally, self.tally));
        }
        if check.faults.is_empty() {
            check.completeness();
        }
        check.faults.all()
    }

    /// The tally, if rays can be sent through the tree without harm, whoever made it: all that [`Self::check`] finds but missing
    /// triangles. O(nodes + blocks).
    pub(super) fn tally_checked(&self, mesh: &Mesh) -> Result<Tally, (Place, Fault)> {
        let mut check = Check::new(self, mesh);
        check.structure();
        let tally = check.tally;
        check.faults.first().map_or(Ok(tally), Err)
    }
}

struct Check<'a> {
    tree: &'a KdTree,
    mesh: &'a Mesh,
    faults: Faults,
    /// Pairs that a parent has claimed.
    seen: Vec<bool>,
    /// What has been found.
    tally: Tally,
}

/// A node to be looked at.
struct Visit {
    node: Node,
    place: Place,
    cell: Aabb,
    depth: usize,
}

const ROOT: Place = Place { part: Part::Root, byte: 0 };

impl<'a> Check<'a> {
    fn new(tree: &'a KdTree, mesh: &'a Mesh) -> Self {
        let seen = vec![false; tree.pairs().len()];
        Self { tree, mesh, faults: Faults::default(), seen, tally: Tally::default() }
    }

    fn structure(&mut self) {
        self.faults.check_blocks(&self.tree.blocks, self.mesh);
        let mut todo = vec![Visit { node: self.tree.root, place: ROOT, cell: self.tree.bounds, depth: 0 }];
        while let Some(visit) = todo.pop() {
            if self.faults.is_full() {
                return;
            }
            self.visit(&visit, &mut todo);
        }
    }

    fn visit(&mut self, &Visit { node, place, cell, depth }: &Visit, todo: &mut Vec<Visit>) {
        self.tally.depth = self.tally.depth.max(depth);
        if depth > StopRule::DEEPEST as usize {
            return self.faults.add(place, format!("a node at depth {depth}; the deepest is {}", StopRule::DEEPEST));
        }
        match node.kind() {
            NodeKind::Leaf { block, lane, count } => self.leaf(place, block, lane, count),
            NodeKind::Interior { axis, split, pair } => {
                let a = axis.index();
                if !(split >= cell.min[a] && split <= cell.max[a]) {
                    self.faults.add(place, format!("plane {split} of axis {a} lies outside its cell {cell:?}"));
                }
                if self.claim(place, pair as usize) {
                    let (left, right) = cell.split(axis, split);
                    for (side, cell) in [left, right].into_iter().enumerate() {
                        let place = Place::of::<Node>(Part::Nodes, 2 * pair as usize + side);
                        todo.push(Visit { node: self.child(pair, side), place, cell, depth: depth + 1 });
                    }
                }
            }
        }
    }

    fn child(&self, pair: u32, side: usize) -> Node {
        self.tree.pairs()[pair as usize][side]
    }

    /// Each pair has one parent, so the links make a tree.
    fn claim(&mut self, parent: Place, pair: usize) -> bool {
        match self.seen.get_mut(pair) {
            None => self.faults.add(parent, format!("pair {pair} is out of range")),
            Some(seen) if *seen => self.faults.add(parent, format!("pair {pair} has two parents")),
            Some(seen) => {
                *seen = true;
                return true;
            }
        }
        false
    }

    /// A leaf's triangles lie in the blocks, and those of all leaves are no more than there is room for: so the longest way of a ray
    /// is bounded, too.
    fn leaf(&mut self, place: Place, block: u32, lane: u32, count: u32) {
        self.tally.leaves += 1;
        self.tally.empty_leaves += usize::from(count == 0);
        self.tally.references = self.tally.references.saturating_add(count as usize);
        let lanes = LANES * self.tree.blocks.len();
        let end = u64::from(block) * LANES as u64 + u64::from(lane) + u64::from(count);
        if lane >= LANES as u32 || count > 0 && end > lanes as u64 {
            self.faults.add(place, format!("a leaf of {count} from block {block}, lane {lane} on is out of range"));
        } else if self.tally.references > lanes {
            self.faults.add(place, format!("more references than the {lanes} lanes of all blocks"));
        }
    }

    /// Sends every triangle down the tree, cut at each plane: where a part arrives, the leaf must have it.
    fn completeness(&mut self) {
        let clipper = TriangleClipper { mesh: self.mesh, scale: self.tree.scale.factor() };
        let Ok(all) = references(&clipper, false) else { return self.faults.add(ROOT, "out of memory".to_owned()) };
        for reference in all {
            let corners = clipper.corners(reference.id);
            let mut todo = vec![(self.tree.root, ROOT, reference)];
            while let Some((node, place, part)) = todo.pop() {
                match node.kind() {
                    NodeKind::Leaf { block, lane, count } => self.expect(place, &part, block, lane, count),
                    NodeKind::Interior { axis, split, pair } => {
                        let (left, right) = self.parts(&part, &corners, axis, split);
                        for (side, part) in [left, right].into_iter().enumerate() {
                            let place = Place::of::<Node>(Part::Nodes, 2 * pair as usize + side);
                            todo.extend(part.map(|part| (self.child(pair, side), place, part)));
                        }
                    }
                }
            }
        }
    }

    /// The parts of a reference on both sides of a plane that are thicker than the slack: thinner ones are covered by what
    /// lies next to them, since rays are thickened by it.
    fn parts(
        &self,
        part: &Reference,
        corners: &[Vec3; 3],
        axis: crate::geom::Axis,
        split: f32,
    ) -> (Option<Reference>, Option<Reference>) {
        let a = axis.index();
        let slack = RayFrame::slack([0.0; 3], self.tree.magnitude);
        let (left, right) = split_triangle(corners, axis, split);
        let keep = |side: Aabb| {
            let side = side.intersection(&part.bounds());
            (!side.is_empty()).then(|| Reference::new(part.id, &side))
        };
        let left = if part.min[a] < split - slack { keep(left) } else { None };
        let right = if part.max[a] > split + slack { keep(right) } else { None };
        (left, right)
    }

    fn expect(&mut self, place: Place, part: &Reference, block: u32, lane: u32, count: u32) {
        let lanes = self.tree.blocks[block as usize..].iter().flat_map(|b| b.ids);
        if !lanes.skip(lane as usize).take(count as usize).any(|id| id == part.id) {
            let (id, bounds) = (part.id, part.bounds());
            self.faults.add(place, format!("triangle {id} is missing from a cell that it reaches into: {bounds:?}"));
        }
    }
}
