//! Rays that make no tile: they wait until there are enough of them.

use super::RAYS;

/// Some of a part's rays, by their numbers.
pub(crate) struct Others {
    rays: [u32; MOST],
    count: usize,
}

/// So many wait, so that few turns are left empty at their end.
const MOST: usize = 16 * RAYS;

impl Others {
    /// None yet.
    pub(crate) fn none() -> Self {
        Self { rays: [0; MOST], count: 0 }
    }

    /// Those that wait.
    pub(crate) fn rays(&self) -> &[u32] {
        &self.rays[..self.count]
    }

    /// Whether there is no room for those of a window.
    #[inline(always)]
    pub(crate) fn are_enough(&self) -> bool {
        self.count > MOST - RAYS
    }

    /// Some more; at most as many as a window has, where there is room.
    #[inline(always)]
    pub(crate) fn add(&mut self, which: &[u32]) {
        self.rays[self.count..][..which.len()].copy_from_slice(which);
        self.count += which.len();
    }

    /// All are done.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }
}
