//! The three-way split: build from the first set, choose by the second, report on the third.

use super::RaySample;
use super::hash::{Purpose, RayHash};

macro_rules! set {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Default, PartialEq)]
        pub struct $name(Vec<RaySample>);

        impl $name {
            /// Declares samples to be of this set. [`Profile::split`](super::Profile::split) does it for recorded rays.
            pub fn from_samples(samples: Vec<RaySample>) -> Self {
                Self(samples)
            }

            /// The samples, in a random but repeatable order: any prefix is a fair sub-sample.
            pub fn samples(&self) -> &[RaySample] {
                &self.0
            }

            /// How many there are.
            pub fn len(&self) -> usize {
                self.0.len()
            }

            /// Whether there are none.
            pub fn is_empty(&self) -> bool {
                self.0.is_empty()
            }
        }
    };
}
set!(
    /// The rays that builders see.
    Training
);
set!(
    /// The rays by which structures are chosen. No builder takes them.
    HeldOut
);
set!(
    /// The rays on which results are reported. Neither builders nor choosers take them.
    Unseen
);

impl Training {
    /// No rays: for heuristics that need none.
    pub fn none() -> Self {
        Self::default()
    }

    /// Two thirds to learn from and a third to choose by, by a hash of the rays' bits that has nothing to do with that of
    /// [`Profile::split`](super::Profile::split).
    pub(crate) fn part(&self) -> (Self, HeldOut) {
        let hash = RayHash::new(0, Purpose::Part);
        let learnt = |s: &&RaySample| !hash.of_ray(&s.ray).is_multiple_of(3);
        let (training, held_out): (Vec<&RaySample>, Vec<&RaySample>) = self.0.iter().partition(learnt);
        let owned = |part: Vec<&RaySample>| part.into_iter().copied().collect();
        (Self(owned(training)), HeldOut(owned(held_out)))
    }
}
