//! From grown branches to the arrays that rays walk: treelets of nodes, packed blocks of triangles.
//!
//! Children lie side by side; four such pairs fill a cache line. A line starts with a pair and takes in the pairs below
//! it that are most likely to be visited, so that several steps of a ray cost one miss (+9–15 % on coherent rays
//! in our prototypes).

use super::branch::{Branch, Branches};
use super::node::Node;
use crate::error::{Error, Result};
use crate::geom::Vec3;
use crate::mem::reserve;
use crate::simd::{Block, LANES};

/// Pairs in a cache line.
const PAIRS: usize = 4;

/// Four pairs of nodes: a cache line.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Line(pub(crate) [Node; 2 * PAIRS]);

/// A finished tree's arrays.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arrays {
    pub(crate) root: Node,
    pub(crate) lines: Vec<Line>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) tally: Tally,
}

/// What was laid out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// The longest way from the root to a leaf, in edges.
    pub depth: usize,
    /// Leaves.
    pub leaves: usize,
    /// Leaves without a triangle.
    pub empty_leaves: usize,
    /// References from leaves to triangles.
    pub references: usize,
}

/// Lays out a grown tree; `corners` gives a triangle's corners.
pub(crate) fn lay_out(branches: &Branches, root: u32, corners: impl Fn(u32) -> [Vec3; 3]) -> Result<Arrays> {
    let mut layout =
        Layout { branches, corners, arrays: Arrays::default(), pairs: 0, lane: LANES, waiting: Vec::new() };
    layout.arrays.root = layout.place(Waiting { branch: root, node: None, chance: 1.0, depth: 0 })?;
    while let Some(next) = layout.waiting.pop() {
        layout.treelet(next)?;
    }
    layout.pad_last_block();
    Ok(layout.arrays)
}

/// A placed interior node whose children are not placed yet.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    branch: u32,
    /// Its own place; none for the root.
    node: Option<usize>,
    chance: f32,
    depth: usize,
}

struct Layout<'a, F> {
    branches: &'a Branches,
    corners: F,
    arrays: Arrays,
    pairs: usize,
    /// The next free lane of the last block.
    lane: usize,
    waiting: Vec<Waiting>,
}

impl<F: Fn(u32) -> [Vec3; 3]> Layout<'_, F> {
    /// Places children until the line is full, always those that are most likely visited; the others wait.
    fn treelet(&mut self, first: Waiting) -> Result<()> {
        let mut frontier = vec![first];
        loop {
            let likeliest =
                (0..frontier.len()).reduce(|a, b| if frontier[b].chance > frontier[a].chance { b } else { a });
            let Some(likeliest) = likeliest else { return Ok(()) };
            let parent = frontier.swap_remove(likeliest);
            self.place_children(parent, &mut frontier)?;
            if self.pairs.is_multiple_of(PAIRS) {
                break;
            }
        }
        frontier.sort_by(|a, b| a.chance.total_cmp(&b.chance));
        self.waiting.append(&mut frontier);
        Ok(())
    }

    fn place_children(&mut self, parent: Waiting, frontier: &mut Vec<Waiting>) -> Result<()> {
        let Branch::Interior { axis, plane, children, chances } = self.branches.nodes[parent.branch as usize] else {
            return Ok(());
        };
        let pair = self.pairs;
        if pair as u64 > u64::from(Node::MAX_LINK) {
            return Err(Error::OverBudget { what: "nodes", limit: Node::MAX_LINK as usize });
        }
        self.pairs += 1;
        if pair.is_multiple_of(PAIRS) {
            reserve(&mut self.arrays.lines, 1, "nodes")?;
            self.arrays.lines.push(Line([Node::default(); 2 * PAIRS]));
        }
        let node = Node::interior(axis, plane, pair as u32);
        match parent.node {
            Some(place) => self.arrays.lines[place / (2 * PAIRS)].0[place % (2 * PAIRS)] = node,
            None => self.arrays.root = node,
        }
        for side in 0..2 {
            let place = 2 * pair + side;
            let chance = parent.chance * chances[side];
            let waiting = Waiting { branch: children[side], node: Some(place), chance, depth: parent.depth + 1 };
            let leaf = self.place(waiting)?;
            self.arrays.lines[place / (2 * PAIRS)].0[place % (2 * PAIRS)] = leaf;
            if matches!(self.branches.nodes[children[side] as usize], Branch::Interior { .. }) {
                // It waits in the line's frontier instead.
                self.waiting.pop();
                frontier.push(waiting);
            }
        }
        Ok(())
    }

    /// A leaf's node, with its triangles placed; an interior node waits.
    fn place(&mut self, waiting: Waiting) -> Result<Node> {
        let tally = &mut self.arrays.tally;
        tally.depth = tally.depth.max(waiting.depth);
        match self.branches.nodes[waiting.branch as usize] {
            Branch::Interior { .. } => {
                self.waiting.push(waiting);
                Ok(Node::default())
            }
            Branch::Leaf { first, count } => {
                tally.leaves += 1;
                tally.empty_leaves += usize::from(count == 0);
                tally.references += count as usize;
                let (branches, range) = (self.branches, first as usize..(first + count) as usize);
                self.place_leaf(&branches.kept[range])
            }
        }
    }

    fn place_leaf(&mut self, ids: &[u32]) -> Result<Node> {
        if ids.is_empty() {
            return Ok(Node::leaf(0, 0, 0));
        }
        let fits = ids.len() <= LANES - self.lane.min(LANES);
        if !fits {
            self.new_block()?;
        }
        let node = Node::leaf(self.arrays.blocks.len() as u32 - 1, self.lane as u32, ids.len() as u32);
        for &id in ids {
            if self.lane == LANES {
                self.new_block()?;
            }
            let corners = (self.corners)(id);
            if let Some(block) = self.arrays.blocks.last_mut() {
                block.set(self.lane, &corners, id);
            }
            self.lane += 1;
        }
        Ok(node)
    }

    fn new_block(&mut self) -> Result<()> {
        self.pad_last_block();
        if self.arrays.blocks.len() as u64 > u64::from(Node::MAX_LINK) {
            return Err(Error::OverBudget { what: "blocks", limit: Node::MAX_LINK as usize });
        }
        reserve(&mut self.arrays.blocks, 1, "blocks of triangles")?;
        self.arrays.blocks.push(bytemuck::Zeroable::zeroed());
        self.lane = 0;
        Ok(())
    }

    /// Unused lanes repeat the last triangle.
    fn pad_last_block(&mut self) {
        let Some(block) = self.arrays.blocks.last_mut() else { return };
        let last = self.lane - 1;
        let (corners, id) = (block.corners(last), block.ids[last]);
        for lane in self.lane..LANES {
            block.set(lane, &corners, id);
        }
    }
}
