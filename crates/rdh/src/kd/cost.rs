//! What nodes and leaves cost: the constants of equation (1), measured once and stored, never calibrated at run time.

use super::spec::LeafWidth;
use crate::heuristic::SplitProbability;

/// c_t and c_i of equation (1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    /// c_t: one step through an interior node.
    pub traverse: f32,
    /// c_i: one test; of one triangle, or of up to eight at once.
    pub intersect: f32,
    /// Splits that cut off empty space count as cheaper by this part.
    pub empty_bonus: f32,
    /// What a test tests.
    pub leaf: LeafWidth,
}

impl Costs {
    /// The stored constants; they suit both widths.
    pub fn of(leaf: LeafWidth) -> Self {
        Self { traverse: 1.0, intersect: 1.5, empty_bonus: 0.1, leaf }
    }

    /// What a leaf of `n` triangles costs.
    #[inline(always)]
    pub fn leaf(&self, n: usize) -> f32 {
        match self.leaf {
            LeafWidth::One => self.intersect * n as f32,
            LeafWidth::Eight => self.intersect * n.div_ceil(8) as f32,
        }
    }

    /// Whether a leaf of `n` triangles takes a single test.
    #[inline(always)]
    pub fn is_one_test(&self, n: usize) -> bool {
        match self.leaf {
            LeafWidth::One => n <= 1,
            LeafWidth::Eight => n <= 8,
        }
    }

    /// What a child of `n` triangles is expected to cost while splits are compared. Steps of eight would hide most
    /// differences, so half of the cost is linear.
    #[inline(always)]
    pub fn child(&self, n: u32) -> f32 {
        match self.leaf {
            LeafWidth::One => self.intersect * n as f32,
            // Signed, since that is what vectors convert; a node has fewer than 2³¹ references.
            LeafWidth::Eight => self.intersect * 0.5 * (((n + 7) >> 3) as i32 as f32 + n as i32 as f32 * 0.125),
        }
    }

    /// Equation (1) for a split into leaves of so many triangles, with the bonus for empty space.
    #[inline(always)]
    pub(crate) fn split(&self, chance: SplitProbability, left: u32, right: u32) -> f32 {
        let cost = self.traverse + chance.left * self.child(left) + chance.right * self.child(right);
        if left == 0 || right == 0 { cost * (1.0 - self.empty_bonus) } else { cost }
    }
}
