//! From cuts to the arrays that rays walk: wide nodes in preorder, the likeliest child first, and packed blocks of triangles.

use rayon::prelude::*;

use super::binary::BinaryNode;
use super::collapse::Cuts;
use super::link::Link;
use crate::error::{Error, Result};
use crate::mem::{joined, reserve};
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

/// A tree to be laid out: a binary one whose leaves hold ranges of `ids`, and how it is cut. Of a node's children those come first for
/// which `order` gives the most; `put` writes a triangle into a lane of a block.
pub(crate) struct Draft<'a, F, G, const W: usize> {
    pub(crate) binary: &'a [BinaryNode],
    pub(crate) ids: &'a [u32],
    pub(crate) cuts: &'a Cuts<W>,
    pub(crate) order: F,
    pub(crate) put: G,
    pub(crate) parallel: bool,
    pub(crate) watch: &'a Watch<'a>,
}

/// Subtrees of up to so many references are laid out by one thread each, into arrays of their own.
const AT_ONCE: u32 = 1 << 14;

impl<F: Fn(usize) -> f32 + Sync, G: Sync, const W: usize> Draft<'_, F, G, W> {
    /// Lays it out: first the nodes above the subtrees, then subtree by subtree.
    pub(crate) fn lay_out<B: Lanes>(&self) -> Result<Arrays<B, W>>
    where
        G: Fn(&mut B, usize, u32),
    {
        let mut top = Layout::new(self, AT_ONCE);
        if self.binary.is_empty() {
            top.new_node()?;
        } else if self.cuts.count(0) <= AT_ONCE {
            top = Layout::new(self, 0);
            top.place_all(0, 0)?;
        } else {
            top.place_all(0, 0)?;
        }
        top.close_blocks();
        let subtrees = std::mem::take(&mut top.subtrees);
        let place = |subtree: &ToPlace| {
            let mut layout = Layout::new(self, 0);
            layout.make_room(self.cuts.count(subtree.node) as usize)?;
            layout.place_all(subtree.node, subtree.depth)?;
            layout.close_blocks();
            Ok(layout.arrays)
        };
        let placed: Result<Vec<_>> =
            if self.parallel { subtrees.par_iter().map(place).collect() } else { subtrees.iter().map(place).collect() };
        self.join(top.arrays, &subtrees, placed?)
    }

    fn join<B: Lanes>(
        &self,
        mut top: Arrays<B, W>,
        subtrees: &[ToPlace],
        placed: Vec<Arrays<B, W>>,
    ) -> Result<Arrays<B, W>> {
        let (mut nodes, mut blocks, mut starts) = (top.nodes.len(), top.blocks.len(), vec![(0, 0)]);
        for (subtree, arrays) in subtrees.iter().zip(&placed) {
            if let Some((parent, lane)) = subtree.parent {
                limit("nodes", nodes, Link::MAX_NODES)?;
                top.nodes[parent].links[lane] = Link::node(nodes).0;
            }
            starts.push((nodes, blocks));
            top.tally.add(&arrays.tally);
            (nodes, blocks) = (nodes + arrays.nodes.len(), blocks + arrays.blocks.len());
        }
        limit("nodes", nodes.saturating_sub(1), Link::MAX_NODES)?;
        limit("blocks of triangles", blocks.saturating_sub(1), Link::MAX_BLOCKS)?;
        let parts = || std::iter::once(&top).chain(&placed);
        let of_nodes: Vec<&[Boxes<W>]> = parts().map(|part| &part.nodes[..]).collect();
        let of_blocks: Vec<&[B]> = parts().map(|part| &part.blocks[..]).collect();
        let nodes = joined(&of_nodes, self.parallel, "nodes", |part, mut node: Boxes<W>| {
            let (nodes, blocks) = starts[part];
            for lane in 0..W {
                if node.is_present(lane) {
                    node.links[lane] = Link(node.links[lane]).after(nodes, blocks).0;
                }
            }
            node
        })?;
        let blocks = joined(&of_blocks, self.parallel, "blocks of triangles", |_, block| block)?;
        Ok(Arrays { nodes, blocks, tally: top.tally })
    }
}

/// Whether the next one can still be named.
fn limit(what: &'static str, next: usize, limit: usize) -> Result<()> {
    if next < limit { Ok(()) } else { Err(Error::OverBudget { what, limit }) }
}

impl Tally {
    fn add(&mut self, part: &Self) {
        self.depth = self.depth.max(part.depth);
        self.interiors += part.interiors;
        self.leaves += part.leaves;
        self.references += part.references;
    }
}

/// A part of a tree while it is laid out.
struct Layout<'a, F, G, B, const W: usize> {
    draft: &'a Draft<'a, F, G, W>,
    /// Subtrees of up to so many references are left for later.
    leave_up_to: u32,
    subtrees: Vec<ToPlace>,
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

impl<'a, F, G, B, const W: usize> Layout<'a, F, G, B, W>
where
    F: Fn(usize) -> f32 + Sync,
    G: Fn(&mut B, usize, u32) + Sync,
    B: Lanes,
{
    fn new(draft: &'a Draft<'a, F, G, W>, leave_up_to: u32) -> Self {
        let arrays = Arrays { nodes: Vec::new(), blocks: Vec::new(), tally: Tally::default() };
        Self { draft, leave_up_to, subtrees: Vec::new(), arrays, open: Vec::new(), gathered: Vec::new() }
    }

    /// For what so many references usually need: arrays that grow are copied.
    fn make_room(&mut self, references: usize) -> Result<()> {
        reserve(&mut self.arrays.nodes, references / 2 / W + 1, "nodes")?;
        reserve(&mut self.arrays.blocks, references / LANES * 5 / 4 + 1, "blocks of triangles")
    }

    /// Depth first: a node, then what lies below its first child.
    fn place_all(&mut self, root: usize, depth: usize) -> Result<()> {
        let Draft { binary, cuts, order, watch, .. } = self.draft;
        let mut todo = vec![ToPlace { node: root, parent: None, depth }];
        while let Some(ToPlace { node, parent, depth }) = todo.pop() {
            let place = self.new_node()?;
            watch.check_at(place)?;
            if let Some((parent, lane)) = parent {
                self.arrays.nodes[parent].links[lane] = Link::node(place).0;
            }
            self.arrays.tally.depth = self.arrays.tally.depth.max(depth + 1);
            let (mut children, n) = self.children(node);
            let children = &mut children[..n];
            let mut ranks = [(0.0, 0); W];
            ranks.iter_mut().zip(&*children).for_each(|(rank, &child)| *rank = (order(child), child));
            ranks[..n].sort_by(|a, b| b.0.total_cmp(&a.0));
            children.iter_mut().zip(ranks).for_each(|(child, (_, ranked))| *child = ranked);
            // Leaves first, so that those of one node share blocks.
            let mut leaves: Vec<usize> = (0..n).filter(|&i| cuts.is_leaf(binary, children[i])).collect();
            leaves.sort_by_key(|&i| std::cmp::Reverse(cuts.count(children[i])));
            for lane in leaves {
                let link = self.place_leaf(children[lane])?;
                self.arrays.nodes[place].set(lane, &binary[children[lane]].0.bounds(), link.0);
            }
            for lane in (0..n).rev().filter(|&i| !cuts.is_leaf(binary, children[i])) {
                self.arrays.nodes[place].set(lane, &binary[children[lane]].0.bounds(), 0);
                let child = ToPlace { node: children[lane], parent: Some((place, lane)), depth: depth + 1 };
                if cuts.count(child.node) <= self.leave_up_to {
                    self.subtrees.push(child);
                } else {
                    todo.push(child);
                }
            }
        }
        Ok(())
    }

    /// A root that is a leaf becomes a node with one child.
    fn children(&self, node: usize) -> ([usize; W], usize) {
        let Draft { binary, cuts, .. } = self.draft;
        if cuts.is_leaf(binary, node) { ([node; W], 1) } else { cuts.children(binary, node) }
    }

    fn new_node(&mut self) -> Result<usize> {
        let place = self.arrays.nodes.len();
        limit("nodes", place, Link::MAX_NODES)?;
        reserve(&mut self.arrays.nodes, 1, "nodes")?;
        self.arrays.nodes.push(Boxes::NONE);
        self.arrays.tally.interiors += 1;
        Ok(place)
    }

    fn gather(&mut self, node: usize) {
        let this = self.draft.binary[node];
        if this.is_interior() {
            self.gather(node + 1);
            self.gather(this.right());
        } else {
            self.gathered.extend_from_slice(&self.draft.ids[this.range()]);
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
            (self.draft.put)(&mut self.arrays.blocks[block], lane + i, id);
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
        limit("blocks of triangles", block, Link::MAX_BLOCKS)?;
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
        (lane..LANES).for_each(|lane| (self.draft.put)(block, lane, id));
    }
}
