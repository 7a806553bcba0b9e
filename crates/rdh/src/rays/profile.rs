//! placeholder
use super::{HeldOut, RaySample, Training, Unseen};
/// A representative ray set.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Profile {
    samples: Vec<RaySample>,
    seen: u64,
}
impl Profile {
    /// samples
    pub fn samples(&self) -> &[RaySample] {
        &self.samples
    }
    /// seen
    pub fn seen(&self) -> u64 {
        self.seen
    }
    /// split
    pub fn split(self, _seed: u64) -> (Training, HeldOut, Unseen) {
        (Training::from_samples(self.samples), HeldOut::default(), Unseen::default())
    }
}
