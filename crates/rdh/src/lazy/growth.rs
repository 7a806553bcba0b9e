//! How much has grown.

use serde::Serialize;

use super::runs;
use super::subtree::{Grown, Subtree};
use super::{Lazy, Tree};
use crate::bvh::Extent;
use crate::geom::{Aabb, TriId};
use crate::mem::bytes_of;

/// What rays have made of a lazy structure so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Growth {
    /// Nodes above whole trees.
    pub upper_nodes: usize,
    /// Trees that have grown in whole, each over some thousand triangles at most.
    pub trees: usize,
    /// Nodes of those trees, leaves not counted.
    pub tree_nodes: usize,
    /// Their leaves.
    pub tree_leaves: usize,
    /// Their triangles.
    pub tree_triangles: usize,
    /// Subtrees that wait for a ray.
    pub waiting: usize,
    /// Triangles below these; the unhittable ones among them included.
    pub waiting_triangles: usize,
    /// Subtrees that must not grow, for lack of memory.
    pub bare: usize,
    /// Triangles of these; the unhittable ones among them included.
    pub bare_triangles: usize,
    /// The longest way from the root to a leaf, or to a subtree that has not grown, in edges.
    pub depth: usize,
}

impl Lazy {
    /// How much has grown.
    pub fn growth(&self) -> Growth {
        let mut growth = Growth::default();
        self.tree.each(&mut |place| {
            let mut depth = place.subtree.depth() as usize;
            match place.subtree.grown() {
                Some(Grown::Node(_)) => growth.upper_nodes += 1,
                Some(Grown::Tree(tree)) => {
                    let tally = tree.tally();
                    growth.trees += 1;
                    growth.tree_nodes += tally.interiors;
                    growth.tree_leaves += tally.leaves;
                    growth.tree_triangles += tally.references;
                    depth += tally.depth;
                }
                Some(Grown::Bare(runs)) => {
                    growth.bare += 1;
                    growth.bare_triangles += runs::count(runs);
                }
                None => {
                    growth.waiting += 1;
                    growth.waiting_triangles += place.subtree.with_waiting(|runs| runs::count(runs));
                }
            }
            growth.depth = growth.depth.max(depth);
        });
        growth
    }

    /// Visits all leaves, and all subtrees that have not grown: box, depth, triangles.
    pub fn cells(&self, visit: &mut dyn FnMut(Aabb, usize, &[u32])) {
        let Tree { ground, .. } = &*self.tree;
        self.tree.each(&mut |place| {
            let depth = place.subtree.depth() as usize;
            let mut bare = |runs: &[Extent]| {
                let ids: Vec<u32> =
                    runs.iter().flat_map(|run| runs::triangles(&ground.mesh, *run)).map(|TriId(id)| id).collect();
                if !ids.is_empty() {
                    visit(ground.space.scale.unscaled(&place.bounds), depth, &ids);
                }
            };
            match place.subtree.grown() {
                Some(Grown::Node(_)) => {}
                Some(Grown::Tree(tree)) => tree.cells(&mut |cell, below, ids| visit(cell, depth + below, ids)),
                Some(Grown::Bare(runs)) => bare(runs),
                None => place.subtree.with_waiting(|runs| bare(runs)),
            }
        });
    }

    /// A hash of what has grown and what waits: equal for equal trees that have grown alike.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        self.tree.each(&mut |place| {
            let mut bare = |kind: u8, runs: &[Extent]| {
                hash.update(&[kind]);
                hash.update(bytes_of(runs));
            };
            match place.subtree.grown() {
                None => place.subtree.with_waiting(|runs| bare(0, runs)),
                Some(Grown::Bare(runs)) => bare(1, runs),
                Some(Grown::Node(node)) => {
                    hash.update(&[2]);
                    hash.update(bytes_of(std::slice::from_ref(&node.boxes)));
                }
                Some(Grown::Tree(tree)) => {
                    hash.update(&[3]);
                    hash.update(&tree.fingerprint().to_le_bytes());
                }
            }
        });
        hash.digest()
    }
}

/// A subtree, and the box that its parent has for it.
pub(super) struct Place<'a> {
    pub(super) subtree: &'a Subtree,
    /// Scaled.
    pub(super) bounds: Aabb,
    /// The box of its parent; its own for the root.
    pub(super) outer: Aabb,
}

impl Tree {
    /// Visits every subtree, parents first, in a fixed order.
    pub(super) fn each<'a>(&'a self, visit: &mut dyn FnMut(&Place<'a>)) {
        let all = self.ground.space.bounds;
        let mut todo = vec![Place { subtree: &self.root, bounds: all, outer: all }];
        while let Some(place) = todo.pop() {
            visit(&place);
            if let Some(Grown::Node(node)) = place.subtree.grown() {
                let child = |(lane, subtree)| Place { subtree, bounds: node.boxes.get(lane), outer: place.bounds };
                todo.extend(node.children.iter().enumerate().map(child).rev());
            }
        }
    }
}
