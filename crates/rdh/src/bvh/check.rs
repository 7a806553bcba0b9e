//! Well-formedness of a whole tree, as a list of faults: nothing is taken on trust.

use super::Bvh;
use super::link::Link;
use crate::fault::{Fault, Faults};
use crate::geom::{Aabb, TriId};
use crate::mesh::Mesh;
use crate::simd::{Boxes, LANES};

impl<const W: usize> Bvh<W> {
    /// All faults of the tree over its mesh, at most 100: links, depth, boxes that do not hold what is below them, ids and copies of
    /// triangles, and triangles that are missing. O(references · depth).
    pub fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        let mut check = Check {
            tree: self,
            mesh,
            faults: Faults::default(),
            seen: vec![false; self.nodes.len()],
            covered: vec![Aabb::EMPTY; mesh.len()],
        };
        check.nodes();
        check.completeness();
        check.faults.0
    }
}

struct Check<'a, const W: usize> {
    tree: &'a Bvh<W>,
    mesh: &'a Mesh,
    faults: Faults,
    /// Nodes that a parent has claimed.
    seen: Vec<bool>,
    /// For each triangle the union of the leaves' boxes that hold it.
    covered: Vec<Aabb>,
}

impl<const W: usize> Check<'_, W> {
    fn nodes(&mut self) {
        if self.tree.nodes.is_empty() {
            return self.faults.add("there is no root".to_owned());
        }
        // A node, the box that its parent has for it, and its depth.
        let mut todo = vec![(0usize, self.tree.bounds, 0usize)];
        while let Some((index, outer, depth)) = todo.pop() {
            if !self.claim(index) {
                continue;
            }
            if depth >= self.tree.tally.depth.max(1) {
                self.faults.add(format!("node {index} lies at depth {depth}, the tree's is {}", self.tree.tally.depth));
            }
            let node: &Boxes<W> = &self.tree.nodes[index];
            for lane in (0..W).filter(|&lane| node.is_present(lane)) {
                let (inner, link) = (node.get(lane), Link(node.links[lane]));
                if inner.union(&outer) != outer {
                    self.faults.add(format!("child {lane} of node {index} reaches out of its parent's box"));
                }
                if link.is_leaf() {
                    self.leaf(link, &inner);
                } else {
                    todo.push((link.index(), inner, depth + 1));
                }
            }
        }
    }

    /// Each node has one parent, so the links make a tree.
    fn claim(&mut self, node: usize) -> bool {
        match self.seen.get_mut(node) {
            None => self.faults.add(format!("node {node} is out of range")),
            Some(seen) if *seen => self.faults.add(format!("node {node} has two parents")),
            Some(seen) => {
                *seen = true;
                return true;
            }
        }
        false
    }

    fn leaf(&mut self, link: Link, bounds: &Aabb) {
        let (first, count) = (link.lane() as usize, link.count() as usize);
        let Some(block) = self.tree.blocks.get(link.block()).filter(|_| first + count <= LANES) else {
            return self.faults.add(format!("leaf {link:?} lies outside of the blocks"));
        };
        for lane in first..first + count {
            let id = block.ids[lane] as usize;
            if id >= self.mesh.len() {
                self.faults.add(format!("triangle {id} does not exist"));
                continue;
            }
            if block.corners(lane) != self.mesh.corners(TriId(id as u32)) {
                self.faults.add(format!("the copy of triangle {id} differs from the mesh"));
            }
            self.covered[id] = self.covered[id].union(bounds);
        }
    }

    /// Every triangle lies in leaves whose boxes hold all of it together. (For the parts of a split triangle this is necessary, not
    /// sufficient; the rest is left to the comparison with brute force.)
    fn completeness(&mut self) {
        let factor = self.tree.scale.factor();
        for tri in self.mesh.solid() {
            let bounds = Aabb::around(&self.mesh.corners(tri).map(|c| c.map(|x| x * factor)));
            let covered = &self.covered[tri.index()];
            if covered.union(&bounds) != *covered {
                self.faults.add(format!("triangle {} is not held by the leaves that list it", tri.0));
            }
        }
    }
}
