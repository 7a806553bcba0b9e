//! Well-formedness of a whole tree, as a list of faults: nothing is taken on trust.

use super::binary::DEEPEST;
use super::link::Link;
use super::{Bvh, Leaves, Tally};
use crate::fault::{Fault, Faults};
use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::parts::{Part, Place};
use crate::simd::{Boxes, LANES, Lanes};

#[expect(private_bounds, reason = "the forms of leaves are a closed set")]
impl<const W: usize, L: Leaves> Bvh<W, L> {
    /// All faults of the tree over its mesh, at most 100: links, depth, boxes that do not hold what is below them, ids and copies of
    /// triangles, and triangles that are missing. O(references).
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
    pub(crate) fn tally_checked(&self, mesh: &Mesh) -> Result<Tally, (Place, Fault)> {
        let mut check = Check::new(self, mesh);
        check.structure();
        let tally = check.tally;
        check.faults.first().map_or(Ok(tally), Err)
    }
}

struct Check<'a, L, const W: usize> {
    tree: &'a Bvh<W, L>,
    mesh: &'a Mesh,
    faults: Faults,
    /// Nodes that a parent has claimed.
    seen: Vec<bool>,
    /// What has been found.
    tally: Tally,
}

/// A node to be looked at.
struct Visit {
    index: usize,
    /// Where the link to it is.
    place: Place,
    /// The box that its parent has for it.
    outer: Aabb,
    depth: usize,
}

const ROOT: Place = Place { part: Part::Nodes, byte: 0 };

impl<'a, L: Leaves, const W: usize> Check<'a, L, W> {
    fn new(tree: &'a Bvh<W, L>, mesh: &'a Mesh) -> Self {
        let seen = vec![false; tree.nodes.len()];
        Self { tree, mesh, faults: Faults::default(), seen, tally: Tally::default() }
    }

    fn structure(&mut self) {
        self.faults.check_blocks(self.tree.leaves.blocks(), self.mesh);
        let mut todo = vec![Visit { index: 0, place: ROOT, outer: self.tree.bounds, depth: 0 }];
        while let Some(visit) = todo.pop() {
            if self.faults.is_full() {
                return;
            }
            self.visit(&visit, &mut todo);
        }
        if let Some(unseen) = self.seen.iter().position(|seen| !seen) {
            let place = Place::of::<Boxes<W>>(Part::Nodes, unseen);
            self.faults.add(place, format!("node {unseen} has no parent"));
        }
    }

    fn visit(&mut self, &Visit { index, place, ref outer, depth }: &Visit, todo: &mut Vec<Visit>) {
        if !self.claim(place, index) {
            return;
        }
        if depth >= DEEPEST as usize {
            return self.faults.add(place, format!("node {index} lies at depth {depth}; {DEEPEST} is too deep"));
        }
        self.tally.interiors += 1;
        let place = Place::of::<Boxes<W>>(Part::Nodes, index);
        let node: &Boxes<W> = &self.tree.nodes[index];
        for lane in 0..W {
            if !node.is_present(lane) {
                if !node.is_absent(lane) {
                    self.faults.add(place, format!("child {lane} of node {index} is neither there nor absent"));
                }
                continue;
            }
            self.tally.depth = self.tally.depth.max(depth + 1);
            let (inner, link) = (node.get(lane), Link(node.links[lane]));
            // Also where a coordinate is no number.
            if !outer.holds(&inner) {
                self.faults.add(place, format!("child {lane} of node {index} reaches out of its parent's box"));
            }
            if link.is_leaf() {
                self.leaf(place, link);
            } else {
                todo.push(Visit { index: link.index(), place, outer: inner, depth: depth + 1 });
            }
        }
    }

    /// Each node has one parent, so the links make a tree.
    fn claim(&mut self, parent: Place, node: usize) -> bool {
        match self.seen.get_mut(node) {
            None => self.faults.add(parent, format!("node {node} is out of range")),
            Some(seen) if *seen => self.faults.add(parent, format!("node {node} has two parents")),
            Some(seen) => {
                *seen = true;
                return true;
            }
        }
        false
    }

    fn leaf(&mut self, place: Place, link: Link) {
        self.tally.leaves += 1;
        self.tally.references += link.count() as usize;
        if link.block() >= self.tree.leaves.blocks().len() || (link.lane() + link.count()) as usize > LANES {
            self.faults.add(place, format!("leaf {link:?} lies outside of the blocks"));
        }
    }

    /// Every triangle lies in leaves whose boxes hold all of it together. (For the parts of a split triangle this is necessary, not
    /// sufficient; the rest is left to the comparison with brute force.)
    fn completeness(&mut self) {
        let covered = self.covered();
        let factor = self.tree.scale.factor();
        for tri in self.mesh.solid() {
            let bounds = Aabb::around(&self.mesh.corners(tri).map(|c| c.map(|x| x * factor)));
            if !covered[tri.index()].holds(&bounds) {
                self.faults.add(ROOT, format!("triangle {} is not held by the leaves that list it", tri.0));
            }
        }
    }

    /// For each triangle the union of the leaves' boxes that hold it; the structure is sound.
    fn covered(&self) -> Vec<Aabb> {
        let mut covered = vec![Aabb::EMPTY; self.mesh.len()];
        for node in &self.tree.nodes[..] {
            for lane in (0..W).filter(|&lane| node.is_present(lane)) {
                let link = Link(node.links[lane]);
                if link.is_leaf() {
                    let lanes = link.lane() as usize..(link.lane() + link.count()) as usize;
                    for &id in &self.tree.leaves.blocks()[link.block()].ids()[lanes] {
                        covered[id as usize] = covered[id as usize].union(&node.get(lane));
                    }
                }
            }
        }
        covered
    }
}
