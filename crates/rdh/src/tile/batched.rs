//! Trees that cast many rays at once.

use super::{Cost, Packed, Prices};
use crate::geom::Ray;
use crate::probe::Counts;

/// A tree that casts parts of batches.
pub(crate) trait Batched {
    /// What its steps cost.
    type Costs: Prices;

    /// The answer of each ray, as one thread casts them; `width` is how many rays a row has, if they are whole rows of a picture.
    fn part<C: Packed>(&self, rays: &[Ray], answers: &mut [C::Output], width: Option<usize>) -> Cost;

    /// Writes down the answer of one ray, and adds what it cost to `counts`.
    fn counted<C: Packed>(&self, ray: &Ray, counts: &mut Counts, answer: &mut C::Output);

    /// The answer of each ray, and what that takes in cycles of a CPU with AVX2, about: by what is counted, not by the time.
    fn effort<C: Packed>(&self, rays: &[Ray], answers: &mut [C::Output]) -> u64 {
        let cost = self.part::<C>(rays, answers, None);
        cost.with_others::<Self::Costs>(rays.len(), |i, counts| self.counted::<C>(&rays[i], counts, &mut answers[i]))
    }
}
