//! What a tile of rays from the eye costs, from counts alone, so that it does not depend on the time.

/// In cycles of a CPU with AVX2, about, as those of the hierarchy's tiles are told: one is held against the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort(u64);

impl Effort {
    /// To make a ray ready, to find its leaves, and to test what it hits.
    const RAY: u64 = 90;
    /// What else a ray takes that ends at the eye: it is made ready in f64, one by one.
    const APPROACH: u64 = 100;
    /// To look at a triangle of a leaf.
    const ENTRY: u64 = 34;
    /// To compare one with eight rays.
    const SEE: u64 = 52;
    /// THE triangle test of one ray.
    const TEST: u64 = 90;
    /// A ray that walks alone.
    const ALONE: u64 = 375;

    /// Nothing.
    pub(super) const NONE: Self = Self(0);

    /// So many rays set out.
    #[inline(always)]
    pub(super) fn rays(&mut self, count: usize) {
        self.0 += Self::RAY * count as u64;
    }

    /// The same for rays that end at the eye.
    #[inline(always)]
    pub(super) fn approach(&mut self, count: usize) {
        self.0 += (Self::RAY + Self::APPROACH) * count as u64;
    }

    /// They look at a triangle, and so many times eight are compared with it.
    #[inline(always)]
    pub(super) fn look(&mut self, seen: u32) {
        self.0 += Self::ENTRY + Self::SEE * u64::from(seen);
    }

    /// So many go through THE triangle test one by one.
    #[inline(always)]
    pub(super) fn test(&mut self, count: u32) {
        self.0 += Self::TEST * u64::from(count);
    }

    /// So many walk alone.
    #[inline(always)]
    pub(super) fn alone(&mut self, count: usize) {
        self.0 += Self::ALONE * count as u64;
    }

    /// All of it.
    pub(super) fn cycles(self) -> u64 {
        self.0
    }
}
