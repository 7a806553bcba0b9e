//! Whether rays come by the same nodes again and again or have to wait for memory: a core's own cache, played through for some of them.

use super::link::Link;

/// The nodes and blocks of leaves that were visited last: each has one place, which it takes from another.
pub(super) struct Recent {
    places: [u32; PLACES],
    visits: u32,
    new: u32,
}

/// Half a megabyte of nodes.
const PLACES: usize = 2048;
/// So many visits fill the places and are not judged: at first all is new.
const FIRST: u32 = 1024;
/// Memory is waited for where one visit in so many is to something new.
const ONE_IN: u32 = 5;

impl Recent {
    /// Nothing was visited.
    pub(super) fn nothing() -> Self {
        Self { places: [u32::MAX; PLACES], visits: 0, new: 0 }
    }

    /// A node or a leaf is visited.
    #[inline(always)]
    pub(super) fn visit(&mut self, link: Link) {
        let what = if link.is_leaf() { link.0 | 63 } else { link.0 };
        // By the golden ratio's bits neighbours get places far apart.
        let place = &mut self.places[(what.wrapping_mul(0x9e37_79b1) >> (u32::BITS - PLACES.ilog2())) as usize];
        self.visits += 1;
        self.new += u32::from(*place != what && self.visits > FIRST);
        *place = what;
    }

    /// Whether so much was new that rays wait for memory.
    pub(super) fn waits(&self) -> bool {
        ONE_IN * self.new > self.visits.saturating_sub(FIRST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waits(nodes: usize) -> bool {
        let mut recent = Recent::nothing();
        (0..4 * FIRST as usize).for_each(|i| recent.visit(Link::node(i * 7919 % nodes)));
        recent.waits()
    }

    #[test]
    fn what_fits_is_not_waited_for() {
        assert!(!waits(1) && !waits(PLACES / 4) && waits(4 * PLACES));
    }

    #[test]
    fn lanes_of_a_block_are_one_place() {
        let mut recent = Recent::nothing();
        (0..2 * FIRST as usize).for_each(|i| recent.visit(Link::leaf(7, i % 8, 1)));
        assert!(!recent.waits() && recent.new == 0);
    }
}
