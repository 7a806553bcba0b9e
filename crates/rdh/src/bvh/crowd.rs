//! Whether a move of a subtree pays for sampled rays: those that meet the node around both its places are counted before and after.
//!
//! A move changes boxes on two ways up, from the subtree's old place and from its new one, to the node where they meet. Each way's
//! boxes are nested, so that a ray is asked from the outermost one inwards, as far as it goes.

use super::binary::BinaryNode;
use super::extent::Extent;
use super::reinsert::{Move, Tree};
use super::visits;
use crate::error::Result;
use crate::geom::Aabb;
use crate::heuristic::{Ranks, Rdh};
use crate::mem::reserve;
use crate::options::Watch;
use crate::simd::Portable;

/// So many rays of a node, a random sub-sample, say what a move around it saves.
const MOST: usize = 256;

/// So many are kept of all nodes together: where everything overlaps, the last nodes have none.
const MOST_IN_ALL: usize = 1 << 22;

/// The sampled rays that meet each node of a tree, as it was before its nodes move.
pub(crate) struct Crowd<'a> {
    rdh: &'a Rdh,
    /// The chance that a ray which meets the root visits each node.
    chances: Vec<f32>,
    /// Each node's range of `rays`.
    ranges: Vec<(u32, u32)>,
    rays: Vec<u32>,
}

/// Boxes around one another, the innermost first, before and after a move.
#[derive(Default)]
struct Change {
    before: Vec<Aabb>,
    after: Vec<Aabb>,
    /// Half areas, summed.
    area_saved: f32,
}

impl<'a> Crowd<'a> {
    /// Sends the heuristic's rays down a tree.
    pub(crate) fn new(nodes: &[BinaryNode], rdh: &'a Rdh, watch: &Watch<'_>) -> Result<Self> {
        let (mut ranges, mut rays) = (Vec::new(), Vec::new());
        reserve(&mut ranges, nodes.len(), "visits")?;
        ranges.resize(nodes.len(), (0, 0));
        let chances = visits::measure(nodes, rdh, watch, |node, of_node| {
            let first = rays.len() as u32;
            let room = MOST_IN_ALL - rays.len();
            rays.extend(of_node.iter().map(|span| span.ray).take(MOST.min(room)));
            ranges[node] = (first, rays.len() as u32);
        })?;
        Ok(Self { rdh, chances, ranges, rays })
    }

    /// Visits of interior nodes, for a ray that meets the root.
    pub(crate) fn cost(&self, nodes: &[BinaryNode]) -> f64 {
        let interiors = nodes.iter().zip(&self.chances).filter(|(node, _)| node.is_interior());
        interiors.map(|(_, &chance)| f64::from(chance)).sum()
    }

    /// The chances that a ray which meets the root visits each node.
    pub(crate) fn into_chances(self) -> Vec<f32> {
        self.chances
    }

    /// How many of the rays meet a node, as far as they are counted.
    pub(crate) fn len(&self, node: u32) -> usize {
        let (first, end) = self.ranges[node as usize];
        (end - first) as usize
    }

    /// How many visits a move saves a ray that meets the root, blended with what areas say.
    pub(crate) fn gain(&self, tree: &Tree, step: &Move) -> f32 {
        let top = tree.meeting(step);
        let (left, joined) = (Change::on_leaving(tree, step, top), Change::on_joining(tree, step, top));
        let (first, end) = self.ranges[top as usize];
        let rays = self.rdh.whole(&self.rays[first as usize..end as usize]);
        let (saved, all) = ((left.saved(&rays) + joined.saved(&rays)) as f32, rays.weight());
        let whole = tree.area(top).max(f32::MIN_POSITIVE);
        let by_area = (left.area_saved + joined.area_saved) / whole;
        self.chances[top as usize] * self.rdh.chance(saved, all, by_area)
    }
}

impl Change {
    /// The way up from where a subtree was: its parent goes, the nodes above shrink.
    fn on_leaving(tree: &Tree, step: &Move, top: u32) -> Self {
        let mut change = Self::default();
        let mut node = tree.parent(step.node);
        change.lose(&tree.extent(node));
        let mut rest = tree.extent(tree.sibling(step.node));
        while node != top && tree.parent(node) != top {
            rest.grow::<Portable>(&tree.extent(tree.sibling(node)));
            node = tree.parent(node);
            change.lose(&tree.extent(node));
            change.win(&rest);
        }
        change
    }

    /// The way up from where it goes: a new parent, and the nodes above grow.
    fn on_joining(tree: &Tree, step: &Move, top: u32) -> Self {
        let mut change = Self::default();
        let (subtree, mut node) = (tree.extent(step.node), step.to);
        while node != top {
            let mut both = tree.extent(node);
            if node != step.to {
                change.lose(&both);
            }
            both.grow::<Portable>(&subtree);
            change.win(&both);
            node = tree.parent(node);
        }
        change
    }

    fn lose(&mut self, extent: &Extent) {
        self.before.push(extent.bounds());
        self.area_saved += extent.half_area();
    }

    fn win(&mut self, extent: &Extent) {
        self.after.push(extent.bounds());
        self.area_saved -= extent.half_area();
    }

    /// How many boxes fewer the rays meet.
    fn saved(&self, rays: &Ranks) -> i64 {
        rays.weigh_nest(&self.before) - rays.weigh_nest(&self.after)
    }
}
