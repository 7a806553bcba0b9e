//! Whether a tile was worth it, from counts alone, so that it does not depend on the time.
//!
//! Fitted to 12,604 groups of 16 tiles that were cast both ways, in eight scenes, by SAH and RDH, rows, shadows, AO and bounces: 4 % of
//! them would be judged wrongly, which costs 0.4 % of the time (Zen 3).

use crate::probe::Counts;

/// What a tile has cost, and what its rays would have cost one by one: in cycles, about, of a CPU with AVX2. Only the ratio matters.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Effort {
    together: u32,
    apart: u32,
}

impl Effort {
    /// To make a ray ready, and to hand over what it hit.
    const READY: u32 = 25;
    /// To lead a tile past a node.
    const NODE: u32 = 55;
    /// A packet against a leaf's cell.
    const CELL: u32 = 60;
    /// The rays of a packet against a triangle, or a ray against a block.
    const SIFT: u32 = 23;
    /// To make a ray ready that goes alone, …
    const RAY: u32 = 60;
    /// … to lead it past a node where its packet comes by, which not all of its rays would, …
    const PACKET_ALONE: u32 = 30;
    /// … and to test it against a block.
    const LEAF_ALONE: u32 = 45;

    /// So much, and a quarter more than its rays would have cost alone, may be spent on a tile.
    const PATIENCE: u32 = 2000;

    /// A tile of so many rays sets out.
    #[inline(always)]
    pub(super) fn of(rays: usize) -> Self {
        Self { together: rays as u32 * Self::READY, apart: rays as u32 * Self::RAY }
    }

    /// So many of its packets come to a node.
    #[inline(always)]
    pub(super) fn node(&mut self, packets: u32) {
        self.together = self.together.wrapping_add(Self::NODE);
        self.apart = self.apart.wrapping_add(Self::PACKET_ALONE * packets);
    }

    /// So many of its packets come to a leaf.
    #[inline(always)]
    pub(super) fn cell(&mut self, packets: u32) {
        self.together = self.together.wrapping_add(Self::CELL * packets);
    }

    /// Some rays of a packet, a bit a lane, are tested against some triangles.
    #[inline(always)]
    pub(super) fn leaf(&mut self, rays: u32, triangles: u32) {
        let (rays, triangles) = (rays.count_ones(), triangles.count_ones());
        self.together = self.together.wrapping_add(Self::SIFT * rays.min(triangles));
        self.apart = self.apart.wrapping_add(Self::LEAF_ALONE * rays);
    }

    /// What it has cost.
    #[inline(always)]
    pub(super) fn cycles(self) -> u64 {
        u64::from(self.together)
    }

    /// What so many rays cost that go alone and do that all together.
    pub(crate) fn alone(rays: u64, counts: &Counts) -> u64 {
        let (node, leaf) = (u64::from(Self::PACKET_ALONE) / 4, u64::from(Self::LEAF_ALONE));
        u64::from(Self::RAY) * rays + node * counts.interiors + leaf * (counts.leaves - counts.empty_leaves)
    }

    /// Whether it has become dear beyond hope, as where a few rays of each packet go on for long: then its rays are to go alone.
    #[inline(always)]
    pub(super) fn is_hopeless(self) -> bool {
        self.together > self.apart + (self.apart >> 2) + Self::PATIENCE
    }

    /// Whether it has paid.
    #[inline(always)]
    pub(super) fn has_paid(self) -> bool {
        self.together <= self.apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_pay_where_rays_stay_together() {
        let mut together = Effort::of(64);
        (0..30).for_each(|_| together.node(6));
        together.cell(30);
        (0..16).for_each(|_| together.leaf(0xff, 0xf));
        assert!(together.has_paid() && !together.is_hopeless());
        let mut apart = Effort::of(64);
        (0..300).for_each(|_| apart.node(1));
        apart.cell(150);
        (0..100).for_each(|_| apart.leaf(1, 0xf));
        assert!(!apart.has_paid() && apart.is_hopeless());
    }
}
