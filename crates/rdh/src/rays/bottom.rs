//! A bottom-k sample: of all distinct rays those with the k smallest hashes, each with the number of its occurrences.
//!
//! Why the counts are exact: a ray is left out only when its hash is not below `limit`, and `limit` only ever falls. A ray
//! that is among the k smallest in the end was below every limit on the way, so not one of its occurrences was left out.
//! Neither the order nor the grouping of the rays matters for which are the smallest, hence the sample depends on the
//! set of rays and the seed alone.

use std::cmp::Ordering;

use super::RaySample;

/// A sample with its hash.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keyed {
    pub(super) hash: u64,
    pub(super) sample: RaySample,
}

impl Keyed {
    /// By hash; equal hashes by everything that tells rays apart, bit for bit.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        self.hash.cmp(&other.hash).then_with(|| self.sample.identity().cmp(&other.sample.identity()))
    }

    /// Takes in another occurrence of the same ray. If the two disagree about the hit, the nearer one stays.
    fn absorb(&mut self, other: &Self) {
        self.sample.weight = self.sample.weight.saturating_add(other.sample.weight);
        self.sample.t_hit = match (self.sample.t_hit, other.sample.t_hit) {
            (Some(a), Some(b)) => Some(if b.total_cmp(&a).is_lt() { b } else { a }),
            (a, b) => a.or(b),
        };
    }
}

/// A bottom-k sample that is being collected.
#[derive(Debug)]
pub(super) struct BottomK {
    capacity: usize,
    /// Rays with smaller hashes are all here.
    limit: u64,
    /// The first `settled` of them are sorted, distinct and no more than `capacity`.
    entries: Vec<Keyed>,
    settled: usize,
}

impl BottomK {
    /// A sample of at most `capacity` rays, all with hashes below `limit`.
    pub(super) fn new(capacity: usize, limit: u64) -> Self {
        let limit = if capacity == 0 { 0 } else { limit };
        Self { capacity, limit, entries: Vec::new(), settled: 0 }
    }

    /// Rays with this hash or a greater one need not be offered.
    pub(super) fn limit(&self) -> u64 {
        self.limit
    }

    /// Offers rays. It works them in whenever there are as many new ones as old ones: memory stays within twice the sample.
    pub(super) fn offer(&mut self, fresh: impl IntoIterator<Item = Keyed>) {
        let limit = self.limit;
        self.entries.extend(fresh.into_iter().filter(|e| e.hash < limit));
        if self.entries.len() - self.settled > self.settled + 1024 {
            self.settle();
        }
    }

    /// The sample, sorted by hash, and the limit below which it is complete.
    pub(super) fn finish(mut self) -> (Vec<RaySample>, u64) {
        self.settle();
        (self.entries.into_iter().map(|e| e.sample).collect(), self.limit)
    }

    fn settle(&mut self) {
        // The stable sort, because it makes use of the part that is sorted already.
        self.entries.sort_by(Keyed::order);
        self.entries.dedup_by(|later, kept| {
            let same = later.order(kept).is_eq();
            if same {
                kept.absorb(later);
            }
            same
        });
        if let Some(last) = self.capacity.checked_sub(1).and_then(|last| self.entries.get(last)) {
            self.limit = self.limit.min(last.hash.saturating_add(1));
        }
        self.entries.truncate(self.capacity);
        self.settled = self.entries.len();
    }
}
