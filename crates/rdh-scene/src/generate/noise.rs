//! Randomness from integers: the same numbers on every platform, in any order of asking.

/// Mixes 64 bits (the finaliser of SplitMix64; Steele, Lea and Flood, OOPSLA 2014).
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A hash of a seed and some integers, such as a room's place in a building.
pub(crate) fn hash(seed: u64, keys: &[i64]) -> u64 {
    keys.iter().fold(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)), |h, &k| {
        mix(h.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ mix(k as u64))
    })
}

/// A sequence of random numbers that belongs to a place: each room, tree or house has its own, so that none depends
/// on how many the others drew.
#[derive(Debug, Clone)]
pub(crate) struct Dice(u64);

impl Dice {
    /// The sequence of a place.
    pub(crate) fn new(seed: u64, keys: &[i64]) -> Self {
        Self(hash(seed, keys))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Evenly from [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly from [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of 0..n; n is not 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// True with probability p.
    pub(crate) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
}

/// Smooth noise in [-1, 1] over the plane: random values at integer points, blended by quintic weights.
pub(crate) fn value_noise(seed: u64, x: f64, y: f64) -> f64 {
    let (ix, iy) = (x.floor(), y.floor());
    let (u, v) = (fade(x - ix), fade(y - iy));
    let at = |dx: i64, dy: i64| Dice::new(seed, &[ix as i64 + dx, iy as i64 + dy]).between(-1.0, 1.0);
    let (low, high) = (at(0, 0) * (1.0 - u) + at(1, 0) * u, at(0, 1) * (1.0 - u) + at(1, 1) * u);
    low * (1.0 - v) + high * v
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}
