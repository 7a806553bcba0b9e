//! `.rays` files: a profile as bytes, version 1.
//!
//! ```text
//!    0  magic "RDH-RAYS"
//!    8  u32 version, u32 layout of a sample
//!   16  u64 xxh3 checksum of all that follows
//!   24  u64 length of the file
//!   32  u64 samples, u64 bytes of settings
//!   48  u64 seed, u64 capacity, u64 limit
//!   72  u64 rays seen of each class (8), u64 invalid ones of each class (8)
//!  200  zeros
//!  256  settings: JSON, padded with zeros to 64 bytes
//!    …  samples, 48 bytes each: f32 ox oy oz dx dy dz t_min t_max, u32 mask, f32 t_hit, u32 weight,
//!       u8 query, u8 class, u8 whether there was a hit, u8 zero
//! ```
//! All little-endian. There is one way only to write a profile, so reading and writing gives the same bytes.

use xxhash_rust::xxh3::xxh3_64;

use super::hash::{Purpose, RayHash};
use super::profile::{Tally, check_json, keyed};
use super::{Profile, Query, RayClass, RaySample};
use crate::error::{Error, Result};
use crate::geom::Ray;

const MAGIC: &[u8; 8] = b"RDH-RAYS";
const VERSION: u32 = 1;
const LAYOUT: u32 = 1;
/// Where the checksummed part begins.
const CHECKED: usize = 24;
const HEADER: usize = 256;
const SAMPLE: usize = 48;
const ALIGN: usize = 64;

impl Profile {
    /// The profile as the content of a `.rays` file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let samples_at = (HEADER + self.settings.len()).next_multiple_of(ALIGN);
        let length = samples_at + self.samples.len() * SAMPLE;
        let mut out = Vec::with_capacity(length);
        out.extend(MAGIC);
        out.extend([VERSION, LAYOUT].map(u32::to_le_bytes).as_flattened());
        let counts = [length, self.samples.len(), self.settings.len()].map(|n| n as u64);
        let words = [0].into_iter().chain(counts).chain([self.seed, self.capacity, self.limit]);
        for word in words.chain(self.tally.seen).chain(self.tally.invalid) {
            out.extend(word.to_le_bytes());
        }
        out.resize(HEADER, 0);
        out.extend(self.settings.as_bytes());
        out.resize(samples_at, 0);
        self.samples.iter().for_each(|s| out.extend(encode(s)));
        let checksum = xxh3_64(&out[CHECKED..]);
        out[16..24].copy_from_slice(&checksum.to_le_bytes());
        out
    }

    /// The profile that a `.rays` file holds. Everything is checked before it is used; memory is only taken for samples
    /// that are really there.
    ///
    /// # Errors
    /// [`Error::Format`] with the place and the reason, if the bytes are no profile, of another version, cut off or altered.
    pub fn from_bytes(data: &[u8]) -> Result<Self> {
        let header = Header::read(data)?;
        let settings = header.settings(data)?;
        let samples = decode_all(&data[header.samples_at..], header.samples_at)?;
        let Header { seed, capacity, limit, tally, .. } = header;
        let profile = Self { samples, tally, seed, capacity, limit, settings };
        profile.check(header.samples_at)?;
        Ok(profile)
    }

    /// The invariants that span samples.
    fn check(&self, samples_at: usize) -> Result<()> {
        if self.samples.len() as u64 > self.capacity {
            return fail(32, format!("{} samples, but a capacity of {}", self.samples.len(), self.capacity));
        }
        let hash = RayHash::new(self.seed, Purpose::Sample);
        let mut weights = [0u64; 8];
        let mut last = None;
        for (i, &sample) in self.samples.iter().enumerate() {
            let at = samples_at + i * SAMPLE;
            let entry = keyed(&hash, sample);
            if entry.hash >= self.limit {
                return fail(at, format!("sample {i}: its hash is not below the limit of the sampling"));
            }
            if last.replace(entry).is_some_and(|last| last.order(&entry).is_ge()) {
                return fail(at, format!("sample {i}: the samples are not in the order of their hashes"));
            }
            weights[sample.class as usize] += u64::from(sample.weight);
        }
        self.check_tally(&weights)
    }

    fn check_tally(&self, weights: &[u64; 8]) -> Result<()> {
        for (class, &weight) in RayClass::ALL.iter().zip(weights) {
            let (seen, invalid) = (self.tally.seen[*class as usize], self.tally.invalid[*class as usize]);
            if invalid > seen || weight > seen - invalid {
                let reason = format!("{}: {seen} rays seen, {invalid} invalid, but {weight} sampled", class.name());
                return fail(72 + 8 * *class as usize, reason);
            }
        }
        Ok(())
    }
}

struct Header {
    settings_len: usize,
    samples_at: usize,
    seed: u64,
    capacity: u64,
    limit: u64,
    tally: Tally,
}

impl Header {
    fn read(data: &[u8]) -> Result<Self> {
        if data.len() < HEADER {
            if !data.starts_with(&MAGIC[..data.len().min(8)]) {
                return fail(0, "this is not a .rays file");
            }
            return fail(data.len(), format!("the file ends within its header of {HEADER} bytes"));
        }
        if &data[..8] != MAGIC {
            return fail(0, "this is not a .rays file");
        }
        expect(8, "version", u32_at(data, 8), VERSION)?;
        expect(12, "layout", u32_at(data, 12), LAYOUT)?;
        let [length, samples, settings] = [24, 32, 40].map(|at| u64_at(data, at));
        if length != data.len() as u64 {
            let at = data.len().min(usize::try_from(length).unwrap_or(usize::MAX));
            return fail(at, format!("{} bytes, but the file should have {length}", data.len()));
        }
        if u64_at(data, 16) != xxh3_64(&data[CHECKED..]) {
            return fail(16, "the checksum does not match: the file was altered or damaged");
        }
        let (settings_len, samples_at) = sections(samples, settings, data.len())?;
        expect_zeros(data, 200..HEADER)?;
        expect_zeros(data, HEADER + settings_len..samples_at)?;
        let per_class = |at: usize| std::array::from_fn(|class| u64_at(data, at + 8 * class));
        let tally = Tally { seen: per_class(72), invalid: per_class(136) };
        let [seed, capacity, limit] = [48, 56, 64].map(|at| u64_at(data, at));
        Ok(Self { settings_len, samples_at, seed, capacity, limit, tally })
    }

    fn settings(&self, data: &[u8]) -> Result<String> {
        let bytes = &data[HEADER..HEADER + self.settings_len];
        let text =
            std::str::from_utf8(bytes).or_else(|e| fail(HEADER + e.valid_up_to(), "the settings are not UTF-8"))?;
        check_json(text).or_else(|(at, reason)| fail(HEADER + at, reason))?;
        Ok(text.to_owned())
    }
}

/// Length of the settings and place of the samples, if these fill a file of `length` bytes exactly.
fn sections(samples: u64, settings: u64, length: usize) -> Result<(usize, usize)> {
    let place = || {
        let samples_at = usize::try_from(settings).ok()?.checked_add(HEADER)?.checked_next_multiple_of(ALIGN)?;
        let end = usize::try_from(samples).ok()?.checked_mul(SAMPLE)?.checked_add(samples_at)?;
        (end == length).then_some((settings as usize, samples_at))
    };
    let reason = || format!("{samples} samples and {settings} bytes of settings don't make {length} bytes");
    place().ok_or_else(|| Error::Format { offset: 32, reason: reason() })
}

fn encode(s: &RaySample) -> [u8; SAMPLE] {
    let mut out = [0; SAMPLE];
    let ray: [u32; 9] = bytemuck::cast(s.ray);
    let words = ray.into_iter().chain([s.t_hit.unwrap_or(0.0).to_bits(), s.weight]);
    for (i, word) in words.enumerate() {
        out[4 * i..4 * i + 4].copy_from_slice(&word.to_le_bytes());
    }
    out[44..47].copy_from_slice(&[s.query as u8, s.class as u8, u8::from(s.t_hit.is_some())]);
    out
}

fn decode_all(data: &[u8], offset: usize) -> Result<Vec<RaySample>> {
    let count = data.len() / SAMPLE;
    let bytes = count * size_of::<RaySample>();
    let mut out = Vec::new();
    out.try_reserve_exact(count).map_err(|_| Error::OutOfMemory { what: "the samples of a profile", bytes })?;
    for (i, record) in data.chunks_exact(SAMPLE).enumerate() {
        out.push(
            decode(record).or_else(|(at, reason)| fail(offset + i * SAMPLE + at, format!("sample {i}: {reason}")))?,
        );
    }
    Ok(out)
}

fn decode(r: &[u8]) -> Result<RaySample, (usize, String)> {
    let ray: Ray = bytemuck::cast(std::array::from_fn::<u32, 9, _>(|i| u32_at(r, 4 * i)));
    let query = *Query::ALL.get(r[44] as usize).ok_or_else(|| (44, format!("there is no query {}", r[44])))?;
    let class = *RayClass::ALL.get(r[45] as usize).ok_or_else(|| (45, format!("there is no class {}", r[45])))?;
    let t_hit = match (r[46], u32_at(r, 36)) {
        (0, 0) => None,
        (1, bits) => Some(f32::from_bits(bits)),
        (flag, _) => return Err((46, format!("{flag} does not say whether there was a hit"))),
    };
    let sample = RaySample { ray, t_hit, query, class, weight: u32_at(r, 40) };
    match sample.fault() {
        Some(fault) => Err((0, fault.to_owned())),
        None if sample.weight == 0 => Err((40, "a weight of 0".to_owned())),
        None if r[47] != 0 => Err((47, "the padding is not zero".to_owned())),
        None => Ok(sample),
    }
}

fn expect(offset: usize, what: &str, got: u32, expected: u32) -> Result<()> {
    if got == expected { Ok(()) } else { fail(offset, format!("{what} {got}; this program reads {what} {expected}")) }
}

fn expect_zeros(data: &[u8], range: std::ops::Range<usize>) -> Result<()> {
    let start = range.start;
    match data[range].iter().position(|&b| b != 0) {
        None => Ok(()),
        Some(i) => fail(start + i, "the padding is not zero"),
    }
}

fn fail<T>(offset: usize, reason: impl Into<String>) -> Result<T> {
    Err(Error::Format { offset, reason: reason.into() })
}

fn u32_at(data: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|i| data[at + i]))
}

fn u64_at(data: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(std::array::from_fn(|i| data[at + i]))
}
