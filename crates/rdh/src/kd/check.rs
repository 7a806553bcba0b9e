//! Well-formedness of a whole tree, as a list of faults: nothing is taken on trust.

use super::node::{Node, NodeKind};
use super::reference::Reference;
use super::{KdTree, references};
use crate::clip::{TriangleClipper, split_triangle};
use crate::fault::{Fault, Faults};
use crate::geom::{Aabb, RayFrame, TriId, Vec3};
use crate::mesh::Mesh;

impl KdTree {
    /// All faults of the tree over its mesh, at most 100: links, depth, planes inside their cells, ids and copies of triangles, and
    /// that no triangle is missing from a cell it reaches into. O(references · depth).
    pub fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        let mut check = Check { tree: self, mesh, faults: Faults::default(), seen: vec![false; self.pairs().len()] };
        check.structure();
        if check.faults.0.is_empty() {
            check.completeness();
        }
        check.faults.0
    }
}

struct Check<'a> {
    tree: &'a KdTree,
    mesh: &'a Mesh,
    faults: Faults,
    /// Pairs that a parent has claimed.
    seen: Vec<bool>,
}

impl Check<'_> {
    fn fault(&mut self, what: String) {
        self.faults.add(what);
    }

    fn structure(&mut self) {
        let mut todo = vec![(self.tree.root, self.tree.bounds, 0usize)];
        while let Some((node, cell, depth)) = todo.pop() {
            if depth > self.tree.tally.depth {
                self.fault(format!("a node lies at depth {depth}, below the tree's {}", self.tree.tally.depth));
            }
            match node.kind() {
                NodeKind::Leaf { block, lane, count } => self.leaf(block, lane, count),
                NodeKind::Interior { axis, split, pair } => {
                    let a = axis.index();
                    if !(split >= cell.min[a] && split <= cell.max[a]) {
                        self.fault(format!("plane {split} of axis {a} lies outside its cell {cell:?}"));
                    }
                    if !self.claim(pair as usize) {
                        continue;
                    }
                    let (left, right) = cell.split(axis, split);
                    todo.push((self.child(pair, 0), left, depth + 1));
                    todo.push((self.child(pair, 1), right, depth + 1));
                }
            }
        }
    }

    fn child(&self, pair: u32, side: usize) -> Node {
        self.tree.pairs()[pair as usize][side]
    }

    /// Each pair has one parent, so the links make a tree.
    fn claim(&mut self, pair: usize) -> bool {
        match self.seen.get_mut(pair) {
            None => self.fault(format!("pair {pair} is out of range")),
            Some(seen) if *seen => self.fault(format!("pair {pair} has two parents")),
            Some(seen) => {
                *seen = true;
                return true;
            }
        }
        false
    }

    fn leaf(&mut self, block: u32, lane: u32, count: u32) {
        for i in 0..count as usize {
            let at = lane as usize + i;
            let Some(block) = self.tree.blocks.get(block as usize + at / 8) else {
                return self.fault(format!("block {block} + {} is out of range", at / 8));
            };
            let id = block.ids[at % 8];
            if id as usize >= self.mesh.len() {
                self.fault(format!("triangle {id} does not exist"));
            } else if block.corners(at % 8) != self.mesh.corners(TriId(id)) {
                self.fault(format!("the copy of triangle {id} differs from the mesh"));
            }
        }
    }

    /// Sends every triangle down the tree, cut at each plane: where a part arrives, the leaf must have it.
    fn completeness(&mut self) {
        let clipper = TriangleClipper { mesh: self.mesh, scale: self.tree.scale.factor() };
        let Ok(all) = references(&clipper) else { return self.fault("out of memory".to_owned()) };
        for reference in all {
            let corners = clipper.corners(reference.id);
            let mut todo = vec![(self.tree.root, reference)];
            while let Some((node, part)) = todo.pop() {
                match node.kind() {
                    NodeKind::Leaf { block, lane, count } => self.expect(&part, block, lane, count),
                    NodeKind::Interior { axis, split, pair } => {
                        let (left, right) = self.parts(&part, &corners, axis, split);
                        todo.extend(left.map(|part| (self.child(pair, 0), part)));
                        todo.extend(right.map(|part| (self.child(pair, 1), part)));
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

    fn expect(&mut self, part: &Reference, block: u32, lane: u32, count: u32) {
        let lanes = self.tree.blocks[block as usize..].iter().flat_map(|b| b.ids);
        if !lanes.skip(lane as usize).take(count as usize).any(|id| id == part.id) {
            self.fault(format!(
                "triangle {} is missing from a cell that it reaches into: {:?}",
                part.id,
                part.bounds()
            ));
        }
    }
}
