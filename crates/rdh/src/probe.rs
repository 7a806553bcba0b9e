//! Counting what a traversal does, without touching the code that users run.

/// Sees every step of a traversal. `()` sees nothing and costs nothing.
pub trait Probe {
    /// Whether it learns anything: where it does, speed matters less than the size of the code.
    const COUNTS: bool = true;

    /// An interior node was visited.
    #[inline(always)]
    fn interior(&mut self) {}
    /// A leaf with so many triangles was visited.
    #[inline(always)]
    fn leaf(&mut self, _triangles: u32) {}
}

impl Probe for () {
    const COUNTS: bool = false;
}

/// What a traversal did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Interior nodes visited.
    pub interiors: u64,
    /// Leaves visited.
    pub leaves: u64,
    /// Leaves visited that hold no triangle.
    pub empty_leaves: u64,
    /// Triangles in the leaves visited; padding is not counted.
    pub tests: u64,
}

impl Counts {
    /// Interior and leaf visits.
    pub fn steps(&self) -> u64 {
        self.interiors + self.leaves
    }
}

impl Probe for Counts {
    #[inline(always)]
    fn interior(&mut self) {
        self.interiors += 1;
    }

    #[inline(always)]
    fn leaf(&mut self, triangles: u32) {
        self.leaves += 1;
        self.empty_leaves += u64::from(triangles == 0);
        self.tests += u64::from(triangles);
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.interiors += other.interiors;
        self.leaves += other.leaves;
        self.empty_leaves += other.empty_leaves;
        self.tests += other.tests;
    }
}
