//! A seeded hash of a ray's bits: it makes sampling repeatable, whatever the order of the rays and their threads.

use super::{Query, RayClass};
use crate::geom::Ray;

/// What a hash is for. Hashes for different purposes are independent, even with the same seed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    /// Which rays are kept, and in which order.
    Sample = 1,
    /// Which set of the three-way split a ray belongs to.
    Split = 2,
    /// Which training rays are held out where there is no other set.
    Part = 3,
}

/// Hashes rays with keys that are drawn from a seed.
#[derive(Debug, Clone, Copy)]
pub(super) struct RayHash {
    keys: [u64; 5],
}

impl RayHash {
    pub(super) fn new(seed: u64, purpose: Purpose) -> Self {
        let start = split_mix(seed ^ split_mix(purpose as u64));
        Self { keys: [1, 2, 3, 4, 5].map(|i: u64| split_mix(start.wrapping_add(i.wrapping_mul(GOLDEN)))) }
    }

    /// Hash of a ray as it is sampled: the same ray asked or used differently is another one.
    #[inline(always)]
    pub(super) fn of_sample(&self, ray: &Ray, query: Query, class: RayClass) -> u64 {
        self.of_tagged(ray, 1 | (query as u32) << 8 | (class as u32) << 16)
    }

    /// Hash of a ray alone.
    pub(super) fn of_ray(&self, ray: &Ray) -> u64 {
        self.of_tagged(ray, 0)
    }

    /// The ray's 36 bytes and the tag make five words; three wide multiplications mix them. This is on the path of every
    /// recorded ray.
    #[inline(always)]
    fn of_tagged(&self, ray: &Ray, tag: u32) -> u64 {
        let (w, k) = (words(ray), &self.keys);
        let start = fold(w[0] ^ k[0], w[1] ^ k[1]);
        let end = fold(w[2] ^ k[2], w[3] ^ k[3]);
        fold(start ^ u64::from(ray.mask) ^ u64::from(tag) << 32, end ^ k[4])
    }
}

/// The bits of a ray without its mask, two numbers in a word, the first one in the lower half: `ox|oy oz|dx dy|dz t_min|t_max`.
#[inline(always)]
pub(super) fn words(ray: &Ray) -> [u64; 4] {
    let (chunks, _mask) = bytemuck::bytes_of(ray).as_chunks();
    // One load each; the compiler does not find that by itself when it is given pairs of numbers.
    let word = |i: usize| {
        let word = u64::from_ne_bytes(chunks[i]);
        if cfg!(target_endian = "big") { word.rotate_left(32) } else { word }
    };
    [word(0), word(1), word(2), word(3)]
}

/// The 128-bit product of two words, its halves combined: each bit of the result depends on all bits of both.
#[inline(always)]
fn fold(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    product as u64 ^ (product >> 64) as u64
}

/// 2⁶⁴ divided by the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of the SplitMix64 generator (Steele, Lea and Flood 2014).
pub(super) fn split_mix(x: u64) -> u64 {
    let x = x.wrapping_add(GOLDEN);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chi-squared of the upper bits over rays that differ as little as those of a camera and a scanner.
    #[test]
    fn hashes_of_regular_rays_are_uniform() {
        let pinhole = |i: usize| {
            let (x, y) = ((i % 512) as f32 / 512.0 - 0.5, (i / 512) as f32 / 512.0 - 0.5);
            Ray::new([1.0, 2.0, 3.0], [x, y, -1.0])
        };
        let parallel = |i: usize| Ray::new([(i % 512) as f32, (i / 512) as f32, 0.0], [0.0, 0.0, 1.0]);
        let by_length = |i: usize| Ray::new([0.0; 3], [0.0, 0.0, 1.0]).within(0.0, i as f32);
        let makers: [&dyn Fn(usize) -> Ray; 3] = [&pinhole, &parallel, &by_length];
        for (maker, make) in makers.iter().enumerate() {
            for seed in [0, 1, u64::MAX] {
                let hash = RayHash::new(seed, Purpose::Sample);
                let mut bins = vec![0u32; 1024];
                for i in 0..1 << 18 {
                    bins[(hash.of_sample(&make(i), Query::Closest, RayClass::Primary) >> 54) as usize] += 1;
                }
                let chi2: f64 = bins.iter().map(|&n| (f64::from(n) - 256.0).powi(2) / 256.0).sum();
                // 1023 degrees of freedom: mean 1023, standard deviation 45.
                assert!((chi2 - 1023.0).abs() < 5.0 * 45.3, "maker {maker}, seed {seed}: {chi2}");
            }
        }
    }

    #[test]
    fn every_bit_of_the_ray_and_its_use_count() {
        let hash = RayHash::new(7, Purpose::Sample);
        let ray = Ray::new([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]).within(0.7, 0.8);
        let reference = hash.of_sample(&ray, Query::Closest, RayClass::Primary);
        for bit in 0..288 {
            let mut words: [u32; 9] = bytemuck::cast(ray);
            words[bit / 32] ^= 1 << (bit % 32);
            let changed =
                (hash.of_sample(&bytemuck::cast(words), Query::Closest, RayClass::Primary) ^ reference).count_ones();
            assert!((10..=54).contains(&changed), "bit {bit} changes {changed} bits");
        }
        assert_ne!(hash.of_sample(&ray, Query::Occluded, RayClass::Primary), reference);
        assert_ne!(hash.of_sample(&ray, Query::Closest, RayClass::Shadow), reference);
        assert_ne!(RayHash::new(7, Purpose::Split).of_sample(&ray, Query::Closest, RayClass::Primary), reference);
        assert_ne!(RayHash::new(8, Purpose::Sample).of_sample(&ray, Query::Closest, RayClass::Primary), reference);
    }
}
