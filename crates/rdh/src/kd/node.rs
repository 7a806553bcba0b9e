//! The 8-byte node. Plain data: saving a tree is writing its nodes.
//!
//! ```text
//! interior:  split plane f32   | pair << 2 | axis (0, 1, 2)     pair: index of the two children, which lie side by side
//! leaf:      lane << 28 | count| block << 2 | 3                 block, lane: where its first triangle is
//! ```
//! A leaf's triangles lie in consecutive lanes of consecutive blocks; one of up to eight never crosses a block's end.

use crate::geom::Axis;

/// A node of a kd-tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Node {
    data: u32,
    link: u32,
}

/// A node unpacked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NodeKind {
    /// A split plane and the pair of its children: left, right.
    Interior {
        /// Which axis is split.
        axis: Axis,
        /// Where, in the structure's scaled space.
        split: f32,
        /// Nodes `2 · pair` and `2 · pair + 1` are its children.
        pair: u32,
    },
    /// Triangles.
    Leaf {
        /// The block of its first triangle.
        block: u32,
        /// The lane of its first triangle.
        lane: u32,
        /// How many triangles it has.
        count: u32,
    },
}

impl Node {
    /// The largest pair or block index.
    pub(crate) const MAX_LINK: u32 = (1 << 30) - 1;
    /// The most triangles of a leaf.
    pub(crate) const MAX_COUNT: u32 = (1 << 28) - 1;

    /// An interior node.
    pub(crate) fn interior(axis: Axis, split: f32, pair: u32) -> Self {
        debug_assert!(pair <= Self::MAX_LINK);
        Self { data: split.to_bits(), link: pair << 2 | axis as u32 }
    }

    /// A leaf.
    pub(crate) fn leaf(block: u32, lane: u32, count: u32) -> Self {
        debug_assert!(block <= Self::MAX_LINK && lane < 8 && count <= Self::MAX_COUNT);
        Self { data: lane << 28 | count, link: block << 2 | 3 }
    }

    /// The same node where so many pairs and blocks come before those of its own part.
    #[inline(always)]
    pub(crate) fn after(self, pairs: u32, blocks: u32) -> Self {
        let more = if self.axis_index() == 3 { blocks } else { pairs };
        Self { link: self.link + (more << 2), ..self }
    }

    /// The axis of an interior node as an index, or 3 for a leaf.
    #[inline(always)]
    pub(crate) fn axis_index(self) -> usize {
        (self.link & 3) as usize
    }

    /// The split plane of an interior node.
    #[inline(always)]
    pub(crate) fn split(self) -> f32 {
        f32::from_bits(self.data)
    }

    /// The pair of children of an interior node.
    #[inline(always)]
    pub(crate) fn pair(self) -> u32 {
        self.link >> 2
    }

    /// Block, lane and number of a leaf's triangles.
    #[inline(always)]
    pub(crate) fn triangles(self) -> (u32, u32, u32) {
        (self.link >> 2, self.data >> 28, self.data & Self::MAX_COUNT)
    }

    /// Unpacks it.
    #[inline(always)]
    pub fn kind(self) -> NodeKind {
        match self.link & 3 {
            3 => {
                let (block, lane, count) = self.triangles();
                NodeKind::Leaf { block, lane, count }
            }
            a => {
                NodeKind::Interior { axis: Axis::ALL[a as usize], split: f32::from_bits(self.data), pair: self.pair() }
            }
        }
    }
}
