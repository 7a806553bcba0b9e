//! Rays that make no tile: they wait until there are enough of them.

use super::RAYS;
use crate::mem::{Slots, Stack};

/// Some of a part's rays, by their numbers.
pub(crate) struct Others<'s>(Stack<'s, u32, MOST>);

/// Memory for them, which is not cleared: small batches would take long for that.
pub(crate) type OthersSlots = Slots<u32, MOST>;

/// So many wait, so that few turns are left empty at their end.
const MOST: usize = 16 * RAYS;

impl<'s> Others<'s> {
    /// None yet.
    #[inline(always)]
    pub(crate) fn none(slots: &'s mut OthersSlots) -> Self {
        Self(slots.stack())
    }

    /// Those that wait.
    pub(crate) fn rays(&self) -> &[u32] {
        self.0.as_slice()
    }

    /// Whether there is no room for those of a window.
    #[inline(always)]
    pub(crate) fn are_enough(&self) -> bool {
        self.0.len() > MOST - RAYS
    }

    /// Some more; at most as many as a window has, where there is room.
    #[inline(always)]
    pub(crate) fn add(&mut self, which: &[u32]) {
        self.0.extend(which);
    }

    /// All are done.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}
