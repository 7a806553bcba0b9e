//! Where streets, blocks and lots are. Metres; the streets' middles are multiples of [`PITCH`].

use crate::generate::noise::Dice;

/// From street to street.
pub(super) const PITCH: f64 = 60.0;
/// Half a street's width, from its middle to the kerb.
pub(super) const KERB: f64 = 7.0;
/// The pavement's height.
pub(super) const PAVEMENT: f64 = 0.15;
/// From a lot's middle to the block's.
pub(super) const LOT: f64 = 10.75;

/// A city's size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) blocks_x: u32,
    pub(super) blocks_y: u32,
    pub(super) seed: u64,
}

impl Layout {
    /// The far corner's streets; the near ones' are at the origin.
    pub(super) fn extent(&self) -> [f64; 2] {
        [PITCH * f64::from(self.blocks_x), PITCH * f64::from(self.blocks_y)]
    }

    /// All blocks.
    pub(super) fn blocks(self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.blocks_y).flat_map(move |j| (0..self.blocks_x).map(move |i| [i, j]))
    }

    /// The middle of a block.
    pub(super) fn centre(&self, block: [u32; 2]) -> [f64; 2] {
        block.map(|i| PITCH * (f64::from(i) + 0.5))
    }

    /// The middle of the block in the city's middle, which is never a park.
    pub(super) fn middle_block(&self) -> [f64; 2] {
        self.centre([self.blocks_x / 2, self.blocks_y / 2].map(|i| i.saturating_sub(1)))
    }

    /// Whether a block is a park.
    pub(super) fn is_park(&self, block: [u32; 2]) -> bool {
        self.dice(1, block).chance(0.15) && self.centre(block) != self.middle_block()
    }

    /// The dice of a block for some purpose.
    pub(super) fn dice(&self, purpose: i64, block: [u32; 2]) -> Dice {
        Dice::new(self.seed, &[purpose, block[0].into(), block[1].into()])
    }
}
