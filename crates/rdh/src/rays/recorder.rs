//! Recording: a fair sample of the rays that an application casts, taken while it casts them.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use super::bottom::{BottomK, Keyed};
use super::hash::{Purpose, RayHash};
use super::profile::Tally;
use super::{Profile, Query, RayClass, RaySample, slots};
use crate::geom::{Hit, Ray};

/// Takes a sample of the rays that are cast, from any number of threads.
///
/// Of all distinct rays it keeps those with the `capacity` smallest hashes of (seed, ray bits, query, class): a fair sample
/// that is the same whatever the order of the rays, the number of threads, and the parts that are recorded apart and
/// [merged](Profile::merge). Rays that are cast more than once count as one sample, whose weight says how often.
///
/// Recording costs a hash and a comparison; only the few rays that get into the sample take a lock, and it is one that
/// no other thread wants. How few: of `n` rays about `capacity · (1 + log2(n / capacity))`, which [`Self::one_in`] lowers.
///
/// ```
/// use rdh::{Query, Ray, RayClass, Recorder};
/// let recorder = Recorder::new(16_384, 1);
/// recorder.record(&Ray::new([0.0; 3], [0.0, 0.0, 1.0]), None, Query::Closest, RayClass::Primary);
/// let profile = recorder.into_profile();
/// assert_eq!((profile.len(), profile.seen()), (1, 1));
/// ```
#[derive(Debug)]
pub struct Recorder {
    hash: RayHash,
    /// Rays with this hash or a greater one are left out. A copy of `kept`'s; it may lag behind, which costs time only.
    limit: AtomicU64,
    slots: Box<[Slot]>,
    kept: Mutex<BottomK>,
    seed: u64,
    capacity: usize,
}

/// What one thread has recorded. Aligned so that no two of them share a cache line.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Slot {
    seen: [AtomicU64; 8],
    invalid: [AtomicU64; 8],
    fresh: Mutex<Vec<Keyed>>,
}

/// So many samples a thread gathers before it hands them on.
const BATCH: usize = 256;

impl Recorder {
    /// A recorder that keeps at most `capacity` distinct rays.
    pub fn new(capacity: usize, seed: u64) -> Self {
        let kept = BottomK::new(capacity, u64::MAX);
        Self {
            hash: RayHash::new(seed, Purpose::Sample),
            limit: AtomicU64::new(kept.limit()),
            slots: (0..slots::COUNT).map(|_| Slot::default()).collect(),
            kept: Mutex::new(kept),
            seed,
            capacity,
        }
    }

    /// Keeps at most one in `rate` distinct rays from the start, so that recording is cheap from the first ray on.
    /// 0 is taken as 1: no such limit.
    pub fn one_in(mut self, rate: u64) -> Self {
        let kept = BottomK::new(self.capacity, u64::MAX / rate.max(1));
        self.limit = AtomicU64::new(kept.limit());
        self.kept = Mutex::new(kept);
        self
    }

    /// Records a ray and where it ended. Rays that [can't hit anything](Ray::is_valid), or whose hit is not at a finite
    /// distance, are counted as invalid and not kept.
    #[inline]
    pub fn record(&self, ray: &Ray, hit: Option<Hit>, query: Query, class: RayClass) {
        let slot = slots::current();
        bump(&self.slots[slot].seen[class as usize], slot);
        let t_hit = hit.map(|h| h.t);
        let hash = self.hash.of_sample(ray, query, class);
        if hash < self.limit.load(Relaxed) || !is_sound(ray, t_hit) {
            self.keep(slot, hash, RaySample { ray: *ray, t_hit, query, class, weight: 1 });
        }
    }

    /// What was recorded.
    pub fn into_profile(self) -> Profile {
        let mut kept = self.kept.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut tally = Tally::default();
        for slot in self.slots {
            for class in 0..8 {
                tally.seen[class] += slot.seen[class].load(Relaxed);
                tally.invalid[class] += slot.invalid[class].load(Relaxed);
            }
            kept.offer(slot.fresh.into_inner().unwrap_or_else(PoisonError::into_inner));
        }
        Profile::from_bottom(kept, tally, self.seed, self.capacity)
    }

    #[cold]
    #[inline(never)]
    fn keep(&self, slot: usize, hash: u64, sample: RaySample) {
        let place = &self.slots[slot];
        if !is_sound(&sample.ray, sample.t_hit) {
            return bump(&place.invalid[sample.class as usize], slot);
        }
        let mut fresh = place.fresh.lock().unwrap_or_else(PoisonError::into_inner);
        fresh.push(Keyed { hash, sample });
        if fresh.len() >= BATCH {
            self.hand_on(&mut fresh);
        }
    }

    fn hand_on(&self, fresh: &mut Vec<Keyed>) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.offer(fresh.drain(..));
        self.limit.store(kept.limit(), Relaxed);
    }
}

/// Whether a ray that ended there can be used.
#[inline(always)]
fn is_sound(ray: &Ray, t_hit: Option<f32>) -> bool {
    ray.is_valid() && t_hit.is_none_or(f32::is_finite)
}

/// Adds 1. A slot with one owner needs no atomic addition, which would cost more than all the rest of recording.
#[inline(always)]
fn bump(counter: &AtomicU64, slot: usize) {
    if slot == slots::SHARED {
        counter.fetch_add(1, Relaxed);
    } else {
        counter.store(counter.load(Relaxed) + 1, Relaxed);
    }
}
