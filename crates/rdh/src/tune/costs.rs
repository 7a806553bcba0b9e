//! What steps and tests cost, by kind of structure: to compare structures by counts.

use crate::bvh::Width;
use crate::spec::{Spec, StructureSpec};

/// Nanoseconds of a step, and of a test of one triangle.
///
/// Their ratios are those that builders weigh by. Their sizes are a fit to 528 times on twelve scenes (docs/measurements.md);
/// for a single scene it is half off, since waiting for memory is not counted, but that meets structures of one kind alike.
/// So counts decide well within a kind, and roughly between kinds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StepCosts {
    pub(super) step: f64,
    pub(super) test: f64,
}

impl StepCosts {
    pub(super) fn of(spec: &Spec) -> Self {
        let (step, test) = match spec.structure {
            StructureSpec::Kd(_) => (5.4, 2.2),
            StructureSpec::Bvh(bvh) => match bvh.width {
                Width::Two => (5.9, 3.5),
                Width::Four => (6.9, 4.1),
                Width::Eight => (7.3, 4.4),
            },
            StructureSpec::Eye(_) => (5.4, 2.2),
            StructureSpec::Auto => unreachable!("what is built is never 'auto'"),
        };
        Self { step, test }
    }

    pub(super) fn nanos(&self, steps: u64, tests: u64) -> f64 {
        self.step * steps as f64 + self.test * tests as f64
    }
}
