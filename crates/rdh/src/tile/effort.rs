//! Whether a tile is worth it, from counts alone, so that it does not depend on the time.

use std::marker::PhantomData;

use crate::probe::Counts;

/// What steps of a kind of tree cost, in cycles, about, of a CPU with AVX2. Only ratios matter.
pub(crate) trait Prices {
    /// To make a ray ready, and to hand over what it hit.
    const READY: u32;
    /// To lead a tile past a node.
    const NODE: u32;
    /// A packet against a leaf's box.
    const BOX: u32;
    /// The rays of a packet against a triangle, or a ray against a block, and THE test of some.
    const SIFT: u32;
    /// To make a ray ready that goes alone, …
    const RAY: u32;
    /// … to lead rays past a node one by one where their packet comes by, which not all of them would, …
    const PACKET_ALONE: u32;
    /// … and to test one against a leaf's block.
    const TEST_ALONE: u32;
    /// Where a single ray's steps are counted: a ray, a node, …
    const COUNTED_RAY: u64;
    /// … a node, …
    const COUNTED_NODE: u64;
    /// … and a leaf that isn't empty.
    const COUNTED_LEAF: u64;

    /// What so many rays cost that go alone and do that all together.
    fn alone(rays: u64, counts: &Counts) -> u64 {
        let leaves = counts.leaves - counts.empty_leaves;
        Self::COUNTED_RAY * rays + Self::COUNTED_NODE * counts.interiors + Self::COUNTED_LEAF * leaves
    }
}

/// What a tile has cost, and what its rays would have cost one by one.
pub(crate) struct Effort<P> {
    together: u32,
    apart: u32,
    prices: PhantomData<P>,
}

impl<P: Prices> Effort<P> {
    /// So much, and a quarter more than its rays would have cost alone so far, may be spent on a tile.
    const PATIENCE: u32 = 3500;

    /// A tile of so many rays sets out.
    #[inline(always)]
    pub(crate) fn of(rays: usize) -> Self {
        Self { together: rays as u32 * P::READY, apart: rays as u32 * P::RAY, prices: PhantomData }
    }

    /// So many of its packets come to a node.
    #[inline(always)]
    pub(crate) fn node(&mut self, packets: u32) {
        self.together = self.together.wrapping_add(P::NODE);
        self.apart = self.apart.wrapping_add(P::PACKET_ALONE * packets);
    }

    /// It comes to a leaf's box with so many packets.
    #[inline(always)]
    pub(crate) fn boxes(&mut self, packets: u32) {
        self.together = self.together.wrapping_add(P::BOX * packets);
    }

    /// Some rays of a packet, a bit a lane, are tested against some triangles.
    #[inline(always)]
    pub(crate) fn leaf(&mut self, rays: u32, triangles: u32) {
        let (rays, triangles) = (rays.count_ones(), triangles.count_ones());
        self.together = self.together.wrapping_add(P::SIFT * rays.min(triangles));
        self.apart = self.apart.wrapping_add(P::TEST_ALONE * rays);
    }

    /// What it has cost.
    #[inline(always)]
    pub(crate) fn cycles(&self) -> u64 {
        u64::from(self.together)
    }

    /// Whether it has become dear beyond hope, as where a few rays of each packet go on for long: then its rays are to go alone.
    #[inline(always)]
    pub(crate) fn is_hopeless(&self) -> bool {
        self.together > self.apart.wrapping_add(self.apart >> 2).wrapping_add(Self::PATIENCE)
    }

    /// Whether it has paid.
    #[inline(always)]
    pub(crate) fn has_paid(&self) -> bool {
        self.together <= self.apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Any;

    impl Prices for Any {
        const READY: u32 = 50;
        const NODE: u32 = 300;
        const BOX: u32 = 100;
        const SIFT: u32 = 50;
        const RAY: u32 = 80;
        const PACKET_ALONE: u32 = 150;
        const TEST_ALONE: u32 = 100;
        const COUNTED_RAY: u64 = 100;
        const COUNTED_NODE: u64 = 20;
        const COUNTED_LEAF: u64 = 80;
    }

    #[test]
    fn tiles_pay_where_rays_stay_together() {
        let mut together = Effort::<Any>::of(64);
        (0..8).for_each(|_| together.node(8));
        (0..16).for_each(|_| together.leaf(0xff, 0xf));
        together.boxes(30);
        assert!(together.has_paid() && !together.is_hopeless());
        let mut apart = Effort::<Any>::of(64);
        (0..200).for_each(|_| apart.node(1));
        (0..100).for_each(|_| apart.leaf(1, 0xf));
        assert!(!apart.has_paid() && apart.is_hopeless());
    }

    #[test]
    fn empty_leaves_cost_nothing() {
        let counts = Counts { interiors: 5, leaves: 3, empty_leaves: 2, ..Counts::default() };
        assert_eq!(Any::alone(2, &counts), 200 + 100 + 80);
    }
}
