//! What a tile of rays from the eye costs, from counts alone, so that it does not depend on the time.

/// In cycles of a CPU with AVX2, about, as those of the hierarchy's tiles are told: one is held against the other.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(super) struct Effort(u64);

impl Effort {
    /// To make a ray ready, to find its leaves, and to test what it hits.
    const RAY: u64 = 35;
    /// To make one ready that ends at the eye, to find its leaves, and to tell its answer.
    const APPROACH: u64 = 40;
    /// To look at a triangle of a leaf.
    const ENTRY: u64 = 44;
    /// To compare one with eight rays, …
    const SEE: u64 = 25;
    /// … and to keep it as what some of them may hit: what was guessed was wrong.
    const KEEP: u64 = 235;
    /// THE triangle test of up to eight of them.
    const TEST: u64 = 80;
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
        self.0 += Self::APPROACH * count as u64;
    }

    /// They look at a triangle, and so many times eight are compared with it.
    #[inline(always)]
    pub(super) fn look(&mut self, seen: u32) {
        self.0 += Self::ENTRY + Self::SEE * u64::from(seen);
    }

    /// Some of eight rays may hit one first.
    #[inline(always)]
    pub(super) fn keep(&mut self) {
        self.0 += Self::KEEP;
    }

    /// Some of eight rays go through THE triangle test.
    #[inline(always)]
    pub(super) fn test(&mut self) {
        self.0 += Self::TEST;
    }

    /// So many walk alone.
    #[inline(always)]
    pub(super) fn alone(&mut self, count: usize) {
        self.0 += Self::ALONE * count as u64;
    }

    /// What may be spent when a tile of so many rays is done that sets out now.
    #[inline(always)]
    pub(super) fn limit(self, rays: usize, budget: Budget) -> Self {
        Self(self.0 + budget.0 * rays as u64)
    }

    /// All of it.
    pub(super) fn cycles(self) -> u64 {
        self.0
    }
}

/// What a ray may cost in a tile on average. A tile that costs more is given up, and its rays are the other structure's: where triangles are
/// small, single tiles cost a hundred times as much as others, and a few of them more than all the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Budget(u64);

impl Budget {
    /// Where nothing is known of the other structure.
    pub(super) const USUAL: Self = Self(8 * Effort::ALONE);

    /// Eight times what so many rays cost in the other structure: tiles that are dear here are dear there, too.
    pub(super) fn of(others: u64, rays: usize) -> Self {
        Self(8 * others / rays.max(1) as u64)
    }
}
