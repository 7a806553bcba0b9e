//! Recording: a fair sample of the rays that an application casts, taken while it casts them.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use super::bottom::{BottomK, Keyed};
use super::hash::{Purpose, RayHash, words};
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
    /// One for each thread, by [`slots::current`].
    owned: Box<[Slot]>,
    /// For the threads that have none.
    shared: Slot,
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
            owned: (0..slots::OWNED).map(|_| Slot::default()).collect(),
            shared: Slot::default(),
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

    /// Records a ray and where it ended. Rays that [can't hit anything](Ray::is_valid) are not kept, and are counted as invalid
    /// unless the caller says that they hit something.
    /// A hit that is not at a finite distance counts as none.
    #[inline(always)]
    pub fn record(&self, ray: &Ray, hit: Option<Hit>, query: Query, class: RayClass) {
        let t_hit = hit.map(|h| h.t);
        let Some(slot) = self.owned.get(slots::current()) else { return self.record_shared(ray, t_hit, query, class) };
        // Only this thread writes here. An atomic addition would cost more than all the rest.
        let seen = &slot.seen[class as usize];
        seen.store(seen.load(Relaxed) + 1, Relaxed);
        if self.stands_out(ray, t_hit, query, class) {
            self.keep(slot, ray, t_hit, query, class);
        }
    }

    /// What was recorded.
    pub fn into_profile(self) -> Profile {
        let mut kept = self.kept.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut tally = Tally::default();
        for slot in self.owned.into_iter().chain([self.shared]) {
            for class in 0..8 {
                tally.seen[class] += slot.seen[class].load(Relaxed);
                tally.invalid[class] += slot.invalid[class].load(Relaxed);
            }
            kept.offer(slot.fresh.into_inner().unwrap_or_else(PoisonError::into_inner));
        }
        Profile::from_bottom(kept, tally, self.seed, self.capacity)
    }

    /// Whether a ray is in the sample, as far as is known now, or invalid. No invalid ray hits anything, so only those that
    /// missed are looked at.
    #[inline(always)]
    fn stands_out(&self, ray: &Ray, t_hit: Option<f32>, query: Query, class: RayClass) -> bool {
        self.hash.of_sample(ray, query, class) < self.limit.load(Relaxed) || t_hit.is_none() && !is_sound(ray)
    }

    #[cold]
    #[inline(never)]
    fn record_shared(&self, ray: &Ray, t_hit: Option<f32>, query: Query, class: RayClass) {
        slots::lease();
        let slot = self.owned.get(slots::current()).unwrap_or(&self.shared);
        slot.seen[class as usize].fetch_add(1, Relaxed);
        if self.stands_out(ray, t_hit, query, class) {
            self.keep(slot, ray, t_hit, query, class);
        }
    }

    #[cold]
    #[inline(never)]
    fn keep(&self, slot: &Slot, ray: &Ray, t_hit: Option<f32>, query: Query, class: RayClass) {
        if !is_sound(ray) {
            // Those that are said to have hit get here by their hash alone: counting them would count some of them.
            slot.invalid[class as usize].fetch_add(u64::from(t_hit.is_none()), Relaxed);
            return;
        }
        let t_hit = t_hit.filter(|t| t.is_finite());
        let sample = RaySample { ray: *ray, t_hit, query, class, weight: 1 };
        let mut fresh = slot.fresh.lock().unwrap_or_else(PoisonError::into_inner);
        fresh.push(Keyed { hash: self.hash.of_sample(ray, query, class), sample });
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

/// The same as [`Ray::is_valid`], but on two numbers at a time and with few branches, since every ray passes here.
#[inline(always)]
fn is_sound(ray: &Ray) -> bool {
    const EXPONENTS: u64 = 0x7f80_0000_7f80_0000;
    const ALL_BUT_SIGNS: u64 = 0x7fff_ffff_7fff_ffff;
    let w = words(ray);
    // An exponent of all ones, and no other, overflows into the bit of the sign.
    let overflows = |word: u64| (word & EXPONENTS) + 0x0080_0000_0080_0000;
    let finite = (overflows(w[0]) | overflows(w[1]) | overflows(w[2])) & !ALL_BUT_SIGNS == 0;
    let moves = (w[1] >> 32 | w[2]) & ALL_BUT_SIGNS != 0;
    finite & moves & (ray.t_min <= ray.t_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sound_rays_are_the_valid_ones() {
        let values =
            [0.0, -0.0, 1.0, -2.5, f32::MIN_POSITIVE / 2.0, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        for place in 0..8 {
            for other in 0..8 {
                for (a, b) in values.iter().flat_map(|a| values.map(|b| (*a, b))) {
                    for rest in [0.0, 1.0] {
                        let mut numbers = [rest; 8];
                        (numbers[place], numbers[other]) = (a, b);
                        let ray = Ray::from(numbers);
                        assert_eq!(is_sound(&ray), ray.is_valid(), "{ray:?}");
                    }
                }
            }
        }
    }
}
