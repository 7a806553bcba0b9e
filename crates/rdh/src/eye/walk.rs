//! The leaves that a rectangle of a face's picture meets.

use super::face::{Face, Kind, Node};
use super::grow::DEEPEST;
use crate::mem::{Slots, Stack};
use crate::simd::Entry;

/// Memory for a walk.
pub(super) type WalkSlots = Slots<Node, { DEEPEST as usize + 1 }>;

/// Yields the entries of one leaf after the other.
pub(super) struct Leaves<'a, 's> {
    face: &'a Face,
    low: [f32; 2],
    high: [f32; 2],
    waiting: Stack<'s, Node, { DEEPEST as usize + 1 }>,
}

impl<'a, 's> Leaves<'a, 's> {
    /// Of a rectangle that lies in the face's window.
    #[inline(always)]
    pub(super) fn new(face: &'a Face, low: [f32; 2], high: [f32; 2], slots: &'s mut WalkSlots) -> Self {
        let mut waiting = slots.stack();
        waiting.push(face.root);
        Self { face, low, high, waiting }
    }

    /// The next leaf.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<&'a [Entry]> {
        let mut node = self.waiting.pop()?;
        loop {
            match node.kind() {
                Kind::Split { axis, at, pair } => {
                    let (low, high) = if axis == 0 { (self.low[0], self.high[0]) } else { (self.low[1], self.high[1]) };
                    let [left, right] = self.face.pairs[pair];
                    node = if high < at {
                        left
                    } else if low >= at {
                        right
                    } else {
                        self.waiting.push(right);
                        left
                    };
                }
                Kind::Leaf { first, count } => return Some(&self.face.entries[first..first + count]),
            }
        }
    }
}
