//! A side's finished tree: plain arrays.

use super::cell::Cell;
use super::grow::{Branch, Reference};
use super::side::Side;
use crate::error::{Error, Result};
use crate::mem::reserve;
use crate::probe::Probe;
use crate::simd::{Corners, Entry, Sight, step_of};

/// A node: eight bytes.
#[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Node {
    /// The bits of the line's place; of a leaf, its first entry.
    data: u32,
    /// Kind in the lowest two bits: the axis, or [`Node::LEAF`]. Above: the pair of children; of a leaf, the number of its entries.
    link: u32,
}

/// What a node is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Rays below the line belong to the first child, all others to the second.
    Split { axis: usize, at: f32, pair: usize },
    /// A range of entries.
    Leaf { first: usize, count: usize },
}

impl Node {
    const LEAF: u32 = 3;
    /// Pairs and entries have 30 bits.
    const MOST: usize = (1 << 30) - 1;

    #[inline(always)]
    pub(super) fn kind(self) -> Kind {
        let (axis, link) = (self.link & 3, (self.link >> 2) as usize);
        if axis == Self::LEAF {
            Kind::Leaf { first: self.data as usize, count: link }
        } else {
            Kind::Split { axis: axis as usize, at: f32::from_bits(self.data), pair: link }
        }
    }
}

/// The tree of one side.
#[derive(Debug, Clone)]
pub(super) struct Face {
    pub(super) side: Side,
    /// The part of the picture that it knows.
    pub(super) window: Cell,
    /// The width of the bundles for which it was cut.
    pub(super) foot: f32,
    pub(super) root: Node,
    /// Children side by side.
    pub(super) pairs: Vec<[Node; 2]>,
    pub(super) entries: Vec<Entry>,
    /// In the order in which leaves name them first.
    pub(super) sights: Vec<Sight>,
    /// The triangles' corners, along the side's axes; the fourth numbers hold the bits of the triangle's id.
    pub(super) corners: Vec<Corners>,
}

impl Face {
    /// The leaf of a place in the window.
    #[inline(always)]
    pub(super) fn leaf_at<P: Probe>(&self, u: f32, v: f32, probe: &mut P) -> &[Entry] {
        let mut node = self.root;
        loop {
            match node.kind() {
                Kind::Split { axis, at, pair } => {
                    probe.interior();
                    let x = if axis == 0 { u } else { v };
                    node = self.pairs[pair][usize::from(x >= at)];
                }
                Kind::Leaf { first, count } => return &self.entries[first..first + count],
            }
        }
    }

    /// Whether the rays in a rectangle of the picture are to walk together: it lies in the window, and is not so wide that most rays have
    /// nothing to do with most cells.
    #[inline(always)]
    pub(super) fn takes(&self, low: [f32; 2], high: [f32; 2]) -> bool {
        const WIDEST: f32 = 256.0;
        let area = (high[0] - low[0] + self.foot) * (high[1] - low[1] + self.foot);
        self.window.has(low[0], low[1]) && self.window.has(high[0], high[1]) && area <= WIDEST * self.foot * self.foot
    }

    /// Leaves without a triangle, and the most edges from the root to a leaf.
    pub(super) fn shape(&self) -> (usize, usize) {
        let (mut empty, mut depth) = (0, 0);
        let mut waiting = vec![(self.root, 0)];
        while let Some((node, edges)) = waiting.pop() {
            match node.kind() {
                Kind::Split { pair, .. } => waiting.extend(self.pairs[pair].map(|child| (child, edges + 1))),
                Kind::Leaf { count, .. } => (empty, depth) = (empty + usize::from(count == 0), depth.max(edges)),
            }
        }
        (empty, depth)
    }

    /// Its arrays' size.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.pairs[..])
            + size_of_val(&self.entries[..])
            + size_of_val(&self.sights[..])
            + size_of_val(&self.corners[..])
    }
}

/// A face while it is laid out.
pub(super) struct Layout<'a, F> {
    face: Face,
    sights: &'a [Sight],
    boxes: &'a [Cell],
    corners: F,
    /// The new number of each sight; none yet.
    places: Vec<u32>,
}

impl<'a, F: Fn(u32) -> Corners> Layout<'a, F> {
    /// Lays out a grown tree; `corners` gives those of a triangle.
    pub(super) fn of(
        (side, window, foot): (Side, Cell, f32),
        branch: &Branch,
        sights: &'a [Sight],
        boxes: &'a [Cell],
        corners: F,
    ) -> Result<Face> {
        let mut places = Vec::new();
        reserve(&mut places, sights.len(), "sights")?;
        places.resize(sights.len(), u32::MAX);
        let (pairs, entries) = (Vec::new(), Vec::new());
        let face =
            Face { side, window, foot, root: Node::default(), pairs, entries, sights: Vec::new(), corners: Vec::new() };
        let mut layout = Self { face, sights, boxes, corners, places };
        layout.face.root = layout.node(branch)?;
        Ok(layout.face)
    }

    /// No deeper than the tree.
    fn node(&mut self, branch: &Branch) -> Result<Node> {
        match branch {
            Branch::Leaf(refs) => self.leaf(refs),
            Branch::Split { axis, at, children } => {
                let pair = self.face.pairs.len();
                limit("nodes", pair)?;
                reserve(&mut self.face.pairs, 1, "nodes")?;
                self.face.pairs.push([Node::default(); 2]);
                for (i, child) in children.iter().enumerate() {
                    self.face.pairs[pair][i] = self.node(child)?;
                }
                Ok(Node { data: at.to_bits(), link: (pair as u32) << 2 | *axis as u32 })
            }
        }
    }

    fn leaf(&mut self, refs: &[Reference]) -> Result<Node> {
        let first = self.face.entries.len();
        limit("references", first + refs.len())?;
        reserve(&mut self.face.entries, refs.len(), "references")?;
        for r in refs {
            let (b, sight) = (self.boxes[r.index as usize], self.sight(r.index)?);
            self.face.entries.push(Entry { low: b.low.map(step_of), high: b.high.map(step_of), near: r.near, sight });
        }
        Ok(Node { data: first as u32, link: (refs.len() as u32) << 2 | Node::LEAF })
    }

    /// The new number of a sight.
    fn sight(&mut self, index: u32) -> Result<u32> {
        let place = self.places[index as usize];
        if place != u32::MAX {
            return Ok(place);
        }
        let (sight, place) = (self.sights[index as usize], self.face.sights.len() as u32);
        reserve(&mut self.face.sights, 1, "sights")?;
        reserve(&mut self.face.corners, 1, "corners")?;
        self.face.sights.push(sight);
        self.face.corners.push((self.corners)(sight.id));
        self.places[index as usize] = place;
        Ok(place)
    }
}

fn limit(what: &'static str, count: usize) -> Result<()> {
    if count > Node::MOST { Err(Error::OverBudget { what, limit: Node::MOST }) } else { Ok(()) }
}
