//! Whether a tile was worth it, from counts alone, so that it does not depend on the time.

use crate::probe::Counts;

/// What a tile has cost, and what its rays would have cost one by one: in cycles, about, of a CPU with AVX2. Only the ratio matters.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Effort {
    together: u32,
    apart: u32,
}

impl Effort {
    /// To make a ray ready, and to hand over what it hit.
    const READY: u32 = 50;
    /// To visit a node with a tile: the beam against its children, their places on the stack, and two packets and more against each.
    const NODE: u32 = 320;
    /// A packet against a leaf's box.
    const BOX: u32 = 25;
    /// Eight rays against a triangle, or a ray against eight, and THE test of every second.
    const SIFT: u32 = 80;
    /// To lead a ray alone to a leaf and test it: one leaf and about three and a half nodes.
    const ALONE: u32 = 165;
    /// What else a ray costs alone.
    const RAY: u32 = 100;
    /// A ray alone at a node, …
    const NODE_ALONE: u64 = 25;
    /// … and at a leaf.
    const LEAF_ALONE: u64 = 75;

    /// A tile of so many rays sets out.
    #[inline(always)]
    pub(super) fn of(rays: usize) -> Self {
        Self { together: rays as u32 * Self::READY, apart: rays as u32 * Self::RAY }
    }

    /// It visits a node.
    #[inline(always)]
    pub(super) fn node(&mut self) {
        self.together = self.together.wrapping_add(Self::NODE);
    }

    /// It comes to a leaf's box with so many packets.
    #[inline(always)]
    pub(super) fn boxes(&mut self, packets: u32) {
        self.together = self.together.wrapping_add(Self::BOX * packets);
    }

    /// Some rays of a packet, a bit a lane, are tested against some triangles.
    #[inline(always)]
    pub(super) fn leaf(&mut self, rays: u32, triangles: u32) {
        let (rays, triangles) = (rays.count_ones(), triangles.count_ones());
        self.together = self.together.wrapping_add(Self::SIFT * rays.min(triangles));
        self.apart = self.apart.wrapping_add(Self::ALONE * rays);
    }

    /// What it has cost.
    #[inline(always)]
    pub(super) fn cycles(self) -> u64 {
        u64::from(self.together)
    }

    /// What so many rays cost that go alone and do that all together.
    pub(crate) fn alone(rays: u64, counts: &Counts) -> u64 {
        u64::from(Self::RAY) * rays + Self::NODE_ALONE * counts.interiors + Self::LEAF_ALONE * counts.leaves
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
        (0..8).for_each(|_| together.node());
        (0..16).for_each(|_| together.leaf(0xff, 0xf));
        together.boxes(30);
        assert!(together.has_paid());
        let mut apart = Effort::of(64);
        (0..500).for_each(|_| apart.node());
        (0..100).for_each(|_| apart.leaf(1, 0xf));
        assert!(!apart.has_paid());
    }
}
