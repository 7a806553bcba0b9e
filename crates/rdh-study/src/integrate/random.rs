//! Random numbers that belong to a film sample, not to a thread: results don't depend on who computes what.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::vector::{V3, add, dot, unit};

/// The random numbers of one film sample.
pub(crate) struct Random(Pcg32);

impl Random {
    /// The generator of sample `index` under `seed`. Neighbours are unrelated: both numbers are mixed first.
    pub(crate) fn new(seed: u64, index: u64) -> Self {
        let state = mix(seed ^ mix(index));
        Self(Pcg32::new(state, mix(state ^ seed)))
    }

    /// Uniform in [0, 1), with 53 bits.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in `0..count`; `count` must not be 0.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// A cosine-distributed direction of length 1 about the unit vector `normal`: the normal plus a point on the unit sphere.
    ///
    /// By rejection and square roots, which all platforms round alike; sines and cosines would differ.
    pub(crate) fn cosine_direction(&mut self, normal: V3) -> V3 {
        unit(add(normal, self.on_sphere())).filter(|d| dot(*d, normal) > 0.0).unwrap_or(normal)
    }

    /// A direction of length 1, uniform over the sphere.
    pub(crate) fn on_sphere(&mut self) -> V3 {
        loop {
            let p = [self.unit(), self.unit(), self.unit()].map(|x| 2.0 * x - 1.0);
            let square = dot(p, p);
            // Too near the centre the direction would be coarse.
            if square <= 1.0 && square > 1e-6 {
                return p.map(|x| x / square.sqrt());
            }
        }
    }
}

/// A seed for another purpose, unrelated to the first.
pub(crate) fn derived_seed(seed: u64, purpose: u64) -> u64 {
    mix(mix(seed).wrapping_add(purpose))
}

/// The finaliser of splitmix64 (Steele, Lea and Flood, OOPSLA 2014): every input bit reaches every output bit.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_directions_have_the_moments_of_the_cosine_lobe() {
        let normal = unit([1.0, 2.0, -2.0]).unwrap();
        let (mut along, mut squared, mut sideways, count) = (0.0, 0.0, [0.0; 3], 200_000);
        for index in 0..count {
            let d = Random::new(7, index).cosine_direction(normal);
            assert!((dot(d, d) - 1.0).abs() < 1e-12 && dot(d, normal) > 0.0);
            along += dot(d, normal);
            squared += dot(d, normal).powi(2);
            sideways = add(sideways, d);
        }
        let n = count as f64;
        // E[cos] = 2/3 and E[cos²] = 1/2; the deviations of cos and cos² are 0.236 and 0.289: 4 standard errors.
        assert!((along / n - 2.0 / 3.0).abs() < 4.0 * 0.236 / n.sqrt());
        assert!((squared / n - 0.5).abs() < 4.0 * 0.289 / n.sqrt());
        // Symmetric about the normal: the mean direction is along it.
        let mean = sideways.map(|x| x / n);
        let off = super::super::vector::sub(mean, normal.map(|x| x * along / n));
        assert!(dot(off, off).sqrt() < 4.0 * 0.5 * 2f64.sqrt() / n.sqrt());
    }

    #[test]
    fn neighbouring_samples_and_seeds_are_unrelated() {
        let n = 100_000u64;
        let pairs = |other: &dyn Fn(u64) -> f64| {
            let mean = (0..n).map(|i| (Random::new(1, i).unit() - 0.5) * (other(i) - 0.5)).sum::<f64>() / n as f64;
            mean * 12.0
        };
        // The correlation of independent samples has a standard error of 1/√n.
        let limit = 4.0 / (n as f64).sqrt();
        assert!(pairs(&|i| Random::new(1, i + 1).unit()).abs() < limit);
        assert!(pairs(&|i| Random::new(2, i).unit()).abs() < limit);
    }
}
