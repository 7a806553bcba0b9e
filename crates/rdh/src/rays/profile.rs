//! A representative ray set (RRS): the sample of rays that structures are built for.

use super::bottom::{BottomK, Keyed};
use super::hash::{Purpose, RayHash};
use super::{HeldOut, RayClass, RaySample, Training, Unseen};
use crate::error::{Error, Result};

/// A fair sample of the rays that an application casts; the paper's representative ray set.
///
/// Invariant: the samples are valid rays, distinct, sorted by their hash, each of weight 1 or more; every distinct ray of the
/// recording whose hash is below `limit` is there, and no other.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    pub(super) samples: Vec<RaySample>,
    pub(super) tally: Tally,
    pub(super) seed: u64,
    pub(super) capacity: u64,
    pub(super) limit: u64,
    pub(super) settings: String,
}

/// How many rays there were, by class.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Tally {
    pub(super) seen: [u64; 8],
    pub(super) invalid: [u64; 8],
}

impl Default for Profile {
    /// The recording of no rays.
    fn default() -> Self {
        Self::from_bottom(BottomK::new(usize::MAX, u64::MAX), Tally::default(), 0, usize::MAX)
    }
}

impl Profile {
    /// A profile of rays that come from elsewhere, as if a recorder without a limit had seen each as often as its weight
    /// says: equal rays become one sample, invalid ones are not kept, and counted unless they are said to have hit something.
    pub fn from_samples(samples: Vec<RaySample>, seed: u64) -> Self {
        let hash = RayHash::new(seed, Purpose::Sample);
        let mut tally = Tally::default();
        for s in &samples {
            tally.seen[s.class as usize] += u64::from(s.weight);
            let invalid = s.t_hit.is_none() && !s.ray.is_valid();
            tally.invalid[s.class as usize] += if invalid { u64::from(s.weight) } else { 0 };
        }
        let sound = samples.into_iter().filter(|s| s.weight > 0 && s.ray.is_valid());
        let mut bottom = BottomK::new(usize::MAX, u64::MAX);
        bottom.offer(sound.map(|s| keyed(&hash, RaySample { t_hit: s.t_hit.filter(|t| t.is_finite()), ..s })));
        Self::from_bottom(bottom, tally, seed, usize::MAX)
    }

    pub(super) fn from_bottom(bottom: BottomK, tally: Tally, seed: u64, capacity: usize) -> Self {
        let (samples, limit) = bottom.finish();
        Self { samples, tally, seed, capacity: capacity as u64, limit, settings: "{}".to_owned() }
    }

    /// The samples, in the order of their hashes: any prefix is a fair sub-sample.
    pub fn samples(&self) -> &[RaySample] {
        &self.samples
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// How many rays were recorded, the invalid ones included.
    pub fn seen(&self) -> u64 {
        saturating_sum(&self.tally.seen)
    }

    /// How many rays of a class were recorded, the invalid ones included.
    pub fn seen_of(&self, class: RayClass) -> u64 {
        self.tally.seen[class as usize]
    }

    /// How many of them were invalid.
    pub fn invalid(&self) -> u64 {
        saturating_sum(&self.tally.invalid)
    }

    /// The seed of the sampling.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The chance that a distinct ray got into the sample: 1 if all are here.
    pub fn rate(&self) -> f64 {
        // 2⁶⁴, to which u64::MAX rounds.
        self.limit as f64 / u64::MAX as f64
    }

    /// Where the rays come from, as JSON: whatever the recording program notes. `{}` at first.
    pub fn settings(&self) -> &str {
        &self.settings
    }

    /// The same rays, with a note of where they come from.
    ///
    /// # Errors
    /// [`Error::Format`] if `json` is not JSON.
    pub fn with_settings(mut self, json: &str) -> Result<Self> {
        check_json(json).map_err(|(offset, reason)| Error::Format { offset, reason })?;
        self.settings = json.to_owned();
        Ok(self)
    }

    /// All of them together: the same profile as if one recorder had seen all rays. It is as large as the largest of
    /// them may be, and as thin as the thinnest one must be, so that it stays fair. The settings stay if all agree.
    ///
    /// # Errors
    /// [`Error::SeedMismatch`] if the seeds differ: such samples have no hash in common.
    pub fn merge(profiles: impl IntoIterator<Item = Self>) -> Result<Self> {
        let mut profiles = profiles.into_iter().enumerate();
        let Some((_, mut all)) = profiles.next() else { return Ok(Self::default()) };
        for (profile, next) in profiles {
            if next.seed != all.seed {
                return Err(Error::SeedMismatch { profile, seed: next.seed, expected: all.seed });
            }
            all.samples.extend(next.samples);
            all.tally.add(&next.tally);
            all.capacity = all.capacity.max(next.capacity);
            all.limit = all.limit.min(next.limit);
            if all.settings != next.settings {
                "{}".clone_into(&mut all.settings);
            }
        }
        let (capacity, limit) = (all.capacity, all.limit);
        Ok(all.cut(capacity, limit))
    }

    /// The `n` samples with the smallest hashes: the same profile as if the recorder's capacity had been `n`.
    pub fn thin(self, n: usize) -> Self {
        let (capacity, limit) = (self.capacity.min(n as u64), self.limit);
        self.cut(capacity, limit)
    }

    /// Only the rays of a class.
    pub fn only(mut self, class: RayClass) -> Self {
        self.samples.retain(|s| s.class == class);
        self.tally = self.tally.only(class);
        self
    }

    /// Three sets that have no ray in common: a half, a quarter and a quarter of the samples, by chance.
    ///
    /// A second hash, of the ray's bits alone and this seed, decides: the same ray is always in the same set, whatever it
    /// was used for and however often, in this profile and in any other one.
    pub fn split(self, seed: u64) -> (Training, HeldOut, Unseen) {
        let [training, held_out, unseen] = self.split_profiles(seed).map(|part| part.samples);
        (Training::from_samples(training), HeldOut::from_samples(held_out), Unseen::from_samples(unseen))
    }

    /// The three sets of [`Self::split`], in that order, as profiles of their own: to keep them in files. Each is as
    /// thin as this one; as seen counts what its samples stand for, since no more is known.
    pub fn split_profiles(self, seed: u64) -> [Self; 3] {
        let hash = RayHash::new(seed, Purpose::Split);
        let empty = Self { samples: Vec::new(), tally: Tally::default(), settings: self.settings.clone(), ..self };
        let mut parts = [empty.clone(), empty.clone(), empty];
        for sample in self.samples {
            let part = match hash.of_ray(&sample.ray) >> 62 {
                0 | 1 => 0,
                2 => 1,
                _ => 2,
            };
            parts[part].tally.seen[sample.class as usize] += u64::from(sample.weight);
            parts[part].samples.push(sample);
        }
        parts
    }

    fn cut(self, capacity: u64, limit: u64) -> Self {
        let hash = RayHash::new(self.seed, Purpose::Sample);
        let mut bottom = BottomK::new(usize::try_from(capacity).unwrap_or(usize::MAX), limit);
        bottom.offer(self.samples.into_iter().map(|s| keyed(&hash, s)));
        let (samples, limit) = bottom.finish();
        Self { samples, capacity, limit, ..self }
    }
}

impl Tally {
    fn add(&mut self, other: &Self) {
        for class in 0..8 {
            self.seen[class] = self.seen[class].saturating_add(other.seen[class]);
            self.invalid[class] = self.invalid[class].saturating_add(other.invalid[class]);
        }
    }

    fn only(&self, class: RayClass) -> Self {
        let mut out = Self::default();
        out.seen[class as usize] = self.seen[class as usize];
        out.invalid[class as usize] = self.invalid[class as usize];
        out
    }
}

/// A file may claim any counts.
fn saturating_sum(counts: &[u64; 8]) -> u64 {
    counts.iter().fold(0, |sum, &n| sum.saturating_add(n))
}

pub(super) fn keyed(hash: &RayHash, sample: RaySample) -> Keyed {
    Keyed { hash: hash.of_sample(&sample.ray, sample.query, sample.class), sample }
}

/// Where and why a text is not JSON.
pub(super) fn check_json(text: &str) -> Result<(), (usize, String)> {
    let not_json = |e: serde_json::Error| {
        let line_start: usize = text.split_inclusive('\n').take(e.line().saturating_sub(1)).map(str::len).sum();
        (line_start + e.column().saturating_sub(1), format!("the settings are not JSON: {e}"))
    };
    serde_json::from_str::<serde::de::IgnoredAny>(text).map(|_| ()).map_err(not_json)
}
