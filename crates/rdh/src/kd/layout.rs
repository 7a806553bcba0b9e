//! From grown branches to the arrays that rays walk: pairs of nodes, packed blocks of triangles.
//!
//! Children lie side by side; four such pairs fill a cache line. A pair is followed by that of the likelier of its nodes that
//! has children: several steps of a ray cost one miss, and where the next step leads can be guessed (`trace.rs`).

use rayon::prelude::*;

use super::branch::{Branch, Branches};
use super::node::Node;
use crate::error::{Error, Result};
use crate::geom::Vec3;
use crate::mem::{joined, reserve};
use crate::options::Watch;
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

/// A grown tree to be laid out; `corners` gives a triangle's corners.
pub(crate) struct Draft<'a, F> {
    pub(crate) branches: &'a Branches,
    pub(crate) corners: F,
    pub(crate) parallel: bool,
    pub(crate) watch: &'a Watch<'a>,
}

/// Subtrees of up to so many nodes are laid out by one thread each, into arrays of their own.
const AT_ONCE: u32 = 1 << 14;

impl<F: Fn(u32) -> [Vec3; 3] + Sync> Draft<'_, F> {
    /// Lays it out: first the nodes above the subtrees, then subtree by subtree.
    pub(crate) fn lay_out(&self, root: u32) -> Result<Arrays> {
        let sizes = self.branches.sizes()?;
        if sizes[root as usize] <= AT_ONCE {
            let Arrays { root, lines, blocks, tally } = Layout::new(self, &[]).lay_out(Waiting::root(root))?.arrays;
            return Ok(Arrays { root, ..Self::join(&[(lines, blocks)], &[(0, 0)], tally, self.parallel)? });
        }
        let Layout { arrays: mut top, subtrees, .. } = Layout::new(self, &sizes).lay_out(Waiting::root(root))?;
        let place = |subtree: &Waiting| Ok(Layout::new(self, &[]).lay_out(*subtree)?.arrays);
        let placed: Result<Vec<Arrays>> =
            if self.parallel { subtrees.par_iter().map(place).collect() } else { subtrees.iter().map(place).collect() };
        let (mut starts, mut lines, mut blocks) = (vec![(0, 0)], top.lines.len(), top.blocks.len());
        let mut parts = Vec::new();
        for (subtree, arrays) in subtrees.iter().zip(placed?) {
            let most = Node::MAX_LINK as usize;
            if (lines + arrays.lines.len()) * PAIRS > most || blocks + arrays.blocks.len() > most {
                return Err(Error::OverBudget { what: "nodes", limit: most });
            }
            let start = ((lines * PAIRS) as u32, blocks as u32);
            if let Some(place) = subtree.node {
                top.lines[place / (2 * PAIRS)].0[place % (2 * PAIRS)] = arrays.root.after(start.0, start.1);
            }
            top.tally.add(&arrays.tally);
            (lines, blocks) = (lines + arrays.lines.len(), blocks + arrays.blocks.len());
            starts.push(start);
            parts.push((arrays.lines, arrays.blocks));
        }
        let Arrays { root, lines, blocks, tally } = top;
        parts.insert(0, (lines, blocks));
        Ok(Arrays { root, ..Self::join(&parts, &starts, tally, self.parallel)? })
    }

    /// The arrays of all parts, of which each begins after so many pairs and blocks.
    fn join(parts: &[Part], starts: &[(u32, u32)], tally: Tally, parallel: bool) -> Result<Arrays> {
        let (lines, blocks): (Vec<_>, Vec<_>) = parts.iter().map(|(lines, blocks)| (&lines[..], &blocks[..])).unzip();
        let lines = joined(&lines, parallel, "nodes", |part, line: Line| {
            let (pairs, blocks) = starts[part];
            Line(line.0.map(|node| node.after(pairs, blocks)))
        })?;
        let blocks = joined(&blocks, parallel, "blocks of triangles", |_, block| block)?;
        Ok(Arrays { root: Node::default(), lines, blocks, tally })
    }
}

/// A part's lines and blocks.
type Part = (Vec<Line>, Vec<Block>);

impl Tally {
    fn add(&mut self, part: &Self) {
        self.depth = self.depth.max(part.depth);
        self.leaves += part.leaves;
        self.empty_leaves += part.empty_leaves;
        self.references += part.references;
    }
}

/// A placed interior node whose children are not placed yet.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    branch: u32,
    /// Its own place; none for the root.
    node: Option<usize>,
    depth: usize,
}

impl Waiting {
    fn root(branch: u32) -> Self {
        Self { branch, node: None, depth: 0 }
    }
}

/// A part of a tree while it is laid out.
struct Layout<'a, F> {
    draft: &'a Draft<'a, F>,
    /// How large subtrees are, where small ones are to be left for later.
    sizes: &'a [u32],
    subtrees: Vec<Waiting>,
    arrays: Arrays,
    pairs: usize,
    /// The next free lane of the last block.
    lane: usize,
    waiting: Vec<Waiting>,
}

impl<'a, F: Fn(u32) -> [Vec3; 3]> Layout<'a, F> {
    fn new(draft: &'a Draft<'a, F>, sizes: &'a [u32]) -> Self {
        let (arrays, subtrees, waiting) = (Arrays::default(), Vec::new(), Vec::new());
        Self { draft, sizes, subtrees, arrays, pairs: 0, lane: LANES, waiting }
    }

    /// A subtree from its root, whose own place is another part's if it has one.
    fn lay_out(mut self, root: Waiting) -> Result<Self> {
        self.arrays.root = self.place(Waiting { node: None, ..root })?;
        let mut placed = 0;
        while let Some(next) = self.waiting.pop() {
            self.draft.watch.check_at(placed)?;
            placed += 1;
            self.place_children(next)?;
        }
        self.pad_last_block();
        Ok(self)
    }

    /// Whether a subtree is left for later.
    fn leaves_out(&self, branch: u32) -> bool {
        self.sizes.get(branch as usize).is_some_and(|&size| size <= AT_ONCE)
    }

    fn place_children(&mut self, parent: Waiting) -> Result<()> {
        let Branch::Interior { axis, plane, children, chances } = self.draft.branches.nodes[parent.branch as usize]
        else {
            return Ok(());
        };
        let pair = self.new_pair()?;
        let node = Node::interior(axis, plane, pair as u32);
        match parent.node {
            Some(place) => self.arrays.lines[place / (2 * PAIRS)].0[place % (2 * PAIRS)] = node,
            None => self.arrays.root = node,
        }
        // The likelier one waits on top, so that its children come next.
        let likelier = usize::from(chances[1] > chances[0]);
        for side in [1 - likelier, likelier] {
            let place = 2 * pair + side;
            let child = Waiting { branch: children[side], node: Some(place), depth: parent.depth + 1 };
            self.arrays.lines[place / (2 * PAIRS)].0[place % (2 * PAIRS)] = self.place(child)?;
        }
        Ok(())
    }

    fn new_pair(&mut self) -> Result<usize> {
        let pair = self.pairs;
        if pair as u64 > u64::from(Node::MAX_LINK) {
            return Err(Error::OverBudget { what: "nodes", limit: Node::MAX_LINK as usize });
        }
        self.pairs += 1;
        if pair.is_multiple_of(PAIRS) {
            reserve(&mut self.arrays.lines, 1, "nodes")?;
            self.arrays.lines.push(Line([Node::default(); 2 * PAIRS]));
        }
        Ok(pair)
    }

    /// A leaf's node, with its triangles placed; an interior node waits.
    fn place(&mut self, node: Waiting) -> Result<Node> {
        let tally = &mut self.arrays.tally;
        tally.depth = tally.depth.max(node.depth);
        match self.draft.branches.nodes[node.branch as usize] {
            Branch::Interior { .. } => {
                let list = if self.leaves_out(node.branch) { &mut self.subtrees } else { &mut self.waiting };
                list.push(node);
                Ok(Node::default())
            }
            Branch::Leaf { first, count } => {
                tally.leaves += 1;
                tally.empty_leaves += usize::from(count == 0);
                tally.references += count as usize;
                let (branches, range) = (self.draft.branches, first as usize..(first + count) as usize);
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
            let corners = (self.draft.corners)(id);
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
