//! What lies in a child's box, in one word.
//!
//! ```text
//! 0 | node                        another node
//! 1 | block | lane | count − 1    25, 3 and 3 bits: a leaf of up to eight triangles in consecutive lanes of one block
//! ```

use crate::simd::LANES;

/// A child of a wide node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Link(pub(crate) u32);

impl Link {
    const LEAF: u32 = 1 << 31;
    /// So many nodes can be told apart.
    pub(crate) const MAX_NODES: usize = 1 << 31;
    /// So many blocks can be told apart.
    pub(crate) const MAX_BLOCKS: usize = 1 << 25;

    /// An interior node, of fewer than 2³¹.
    #[inline(always)]
    pub(crate) fn node(index: usize) -> Self {
        debug_assert!(index < Self::MAX_NODES, "node {index} has no number");
        Self(index as u32)
    }

    /// A leaf of 1 to 8 triangles within one block.
    #[inline(always)]
    pub(crate) fn leaf(block: usize, lane: usize, count: usize) -> Self {
        debug_assert!(
            block < Self::MAX_BLOCKS && count >= 1 && lane + count <= LANES,
            "no leaf: {block} {lane} {count}"
        );
        Self(Self::LEAF | (block as u32) << 6 | (lane as u32) << 3 | (count as u32 - 1))
    }

    /// The same child where so many nodes and blocks come before those of its own part.
    #[inline(always)]
    pub(crate) fn after(self, nodes: usize, blocks: usize) -> Self {
        if self.is_leaf() {
            Self::leaf(self.block() + blocks, self.lane() as usize, self.count() as usize)
        } else {
            Self::node(self.index() + nodes)
        }
    }

    /// Whether it is a leaf.
    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// A node's index.
    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }

    /// A leaf's block.
    #[inline(always)]
    pub(crate) fn block(self) -> usize {
        ((self.0 & !Self::LEAF) >> 6) as usize
    }

    /// A leaf's first lane.
    #[inline(always)]
    pub(crate) fn lane(self) -> u32 {
        (self.0 >> 3) & 7
    }

    /// How many triangles a leaf has.
    #[inline(always)]
    pub(crate) fn count(self) -> u32 {
        (self.0 & 7) + 1
    }

    /// A leaf's lanes, a bit each.
    #[inline(always)]
    pub(crate) fn lanes(self) -> u32 {
        (0xff >> (7 - (self.0 & 7))) << self.lane()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_what_it_was_made_of() {
        for block in [0, 1, 12_345, Link::MAX_BLOCKS - 1] {
            for lane in 0..LANES {
                for count in 1..=LANES - lane {
                    let leaf = Link::leaf(block, lane, count);
                    assert!(leaf.is_leaf());
                    assert_eq!((leaf.block(), leaf.lane() as usize, leaf.count() as usize), (block, lane, count));
                    assert_eq!(leaf.lanes(), ((1 << count) - 1) << lane);
                }
            }
        }
        assert!(!Link::node(7).is_leaf() && Link::node(7).index() == 7);
    }
}
