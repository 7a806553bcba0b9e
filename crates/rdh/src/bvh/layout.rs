//! From cuts to the arrays that rays walk: wide nodes in preorder, the likeliest child first, and packed blocks of triangles.

use super::binary::BinaryNode;
use super::collapse::Cuts;
use super::link::Link;
use crate::error::{Error, Result};
use crate::mem::{reserve, settled};
use crate::options::Watch;
use crate::simd::{Boxes, LANES, Lanes};

/// A finished tree's arrays.
#[derive(Debug, Clone)]
pub(crate) struct Arrays<B, const W: usize> {
    pub(crate) nodes: Vec<Boxes<W>>,
    pub(crate) blocks: Vec<B>,
    pub(crate) tally: Tally,
}

/// What was laid out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// The longest way from the root to a leaf, in edges.
    pub depth: usize,
    /// Interior nodes.
    pub interiors: usize,
    /// Leaves.
    pub leaves: usize,
    /// References from leaves to triangles.
    pub references: usize,
}

/// Lays out a binary tree whose leaves hold ranges of `ids`. Of a node's children those come first for
/// which `order` gives the most; `put` writes a triangle into a lane.
pub(crate) fn lay_out<B: Lanes, const W: usize>(
    binary: &[BinaryNode],
    ids: &[u32],
    cuts: &Cuts<W>,
    order: impl Fn(usize) -> f32,
    put: impl Fn(&mut B, usize, u32),
    watch: &Watch<'_>,
) -> Result<Arrays<B, W>> {
    let arrays = Arrays { nodes: Vec::new(), blocks: Vec::new(), tally: Tally::default() };
    let (open, gathered) = (Vec::new(), Vec::new());
    let mut layout = Layout { binary, ids, cuts, order, put, watch, arrays, open, gathered };
    if binary.is_empty() {
        layout.new_node()?;
    } else {
        layout.place_all()?;
    }
    layout.close_blocks();
    let Arrays { nodes, blocks, tally } = layout.arrays;
    Ok(Arrays { nodes: settled(&nodes, "nodes")?, blocks: settled(&blocks, "blocks of triangles")?, tally })
}

struct Layout<'a, F, G, B, const W: usize> {
    binary: &'a [BinaryNode],
    ids: &'a [u32],
    cuts: &'a Cuts<W>,
    order: F,
    put: G,
    watch: &'a Watch<'a>,
    arrays: Arrays<B, W>,
    /// Blocks with room: which, and the first free lane.
    open: Vec<(usize, usize)>,
    /// A leaf's triangles.
    gathered: Vec<u32>,
}

/// A binary node whose wide node is to be made, the place and lane that link to it, and its depth.
struct ToPlace {
    node: usize,
    parent: Option<(usize, usize)>,
    depth: usize,
}

/// Blocks that may wait for more triangles at the same time; leaves that lie far apart should not share one.
const OPEN: usize = 4;

impl<F: Fn(usize) -> f32, G: Fn(&mut B, usize, u32), B: Lanes, const W: usize> Layout<'_, F, G, B, W> {
    /// Depth first: a node, then what lies below its first child.
    fn place_all(&mut self) -> Result<()> {
        let mut todo = vec![ToPlace { node: 0, parent: None, depth: 0 }];
        while let Some(ToPlace { node, parent, depth }) = todo.pop() {
            let place = self.new_node()?;
            self.watch.check_at(place)?;
            if let Some((parent, lane)) = parent {
                self.arrays.nodes[parent].links[lane] = Link::node(place).0;
            }
            self.arrays.tally.depth = self.arrays.tally.depth.max(depth + 1);
            let (mut children, n) = self.children(node);
            let children = &mut children[..n];
            children.sort_by(|&a, &b| (self.order)(b).total_cmp(&(self.order)(a)));
            // Leaves first, so that those of one node share blocks.
            let mut leaves: Vec<usize> = (0..n).filter(|&i| self.cuts.is_leaf(self.binary, children[i])).collect();
            leaves.sort_by_key(|&i| std::cmp::Reverse(self.cuts.count(children[i])));
            for lane in leaves {
                let link = self.place_leaf(children[lane])?;
                self.arrays.nodes[place].set(lane, &self.binary[children[lane]].0.bounds(), link.0);
            }
            for lane in (0..n).rev().filter(|&i| !self.cuts.is_leaf(self.binary, children[i])) {
                self.arrays.nodes[place].set(lane, &self.binary[children[lane]].0.bounds(), 0);
                todo.push(ToPlace { node: children[lane], parent: Some((place, lane)), depth: depth + 1 });
            }
        }
        Ok(())
    }

    /// A root that is a leaf becomes a node with one child.
    fn children(&self, node: usize) -> ([usize; W], usize) {
        if self.cuts.is_leaf(self.binary, node) { ([node; W], 1) } else { self.cuts.children(self.binary, node) }
    }

    fn new_node(&mut self) -> Result<usize> {
        let place = self.arrays.nodes.len();
        if place >= Link::MAX_NODES {
            return Err(Error::OverBudget { what: "nodes", limit: Link::MAX_NODES });
        }
        reserve(&mut self.arrays.nodes, 1, "nodes")?;
        self.arrays.nodes.push(Boxes::NONE);
        self.arrays.tally.interiors += 1;
        Ok(place)
    }

    fn gather(&mut self, node: usize) {
        let this = self.binary[node];
        if this.is_interior() {
            self.gather(node + 1);
            self.gather(this.right());
        } else {
            self.gathered.extend_from_slice(&self.ids[this.range()]);
        }
    }

    /// Puts a leaf's triangles, each once, into the first open block that has room, or into a new one.
    fn place_leaf(&mut self, node: usize) -> Result<Link> {
        self.gathered.clear();
        self.gather(node);
        self.gathered.sort_unstable();
        self.gathered.dedup();
        let count = self.gathered.len();
        let open = match self.open.iter().position(|&(_, lane)| lane + count <= LANES) {
            Some(open) => open,
            None => self.open_block()?,
        };
        let (block, lane) = self.open[open];
        for (i, &id) in self.gathered.iter().enumerate() {
            (self.put)(&mut self.arrays.blocks[block], lane + i, id);
        }
        self.open[open].1 += count;
        if self.open[open].1 == LANES {
            self.open.remove(open);
        }
        self.arrays.tally.leaves += 1;
        self.arrays.tally.references += count;
        Ok(Link::leaf(block, lane, count))
    }

    fn open_block(&mut self) -> Result<usize> {
        let block = self.arrays.blocks.len();
        if block >= Link::MAX_BLOCKS {
            return Err(Error::OverBudget { what: "blocks of triangles", limit: Link::MAX_BLOCKS });
        }
        reserve(&mut self.arrays.blocks, 1, "blocks of triangles")?;
        self.arrays.blocks.push(bytemuck::Zeroable::zeroed());
        if self.open.len() == OPEN {
            let (block, lane) = self.open.remove(0);
            self.pad(block, lane);
        }
        self.open.push((block, 0));
        Ok(self.open.len() - 1)
    }

    fn close_blocks(&mut self) {
        for (block, lane) in std::mem::take(&mut self.open) {
            self.pad(block, lane);
        }
    }

    /// Unused lanes repeat the last triangle.
    fn pad(&mut self, block: usize, lane: usize) {
        let block = &mut self.arrays.blocks[block];
        let id = block.ids()[lane - 1];
        (lane..LANES).for_each(|lane| (self.put)(block, lane, id));
    }
}
