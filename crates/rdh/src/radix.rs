//! Sorting by radix: linear in the number of keys.

/// A key that sorts as the number does; -0 and 0 are one.
#[inline(always)]
pub(crate) fn key(x: f32) -> u32 {
    let bits = (x + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The number of a key.
#[inline(always)]
pub(crate) fn value(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 { key & !(1 << 31) } else { !key })
}

/// Fewer keys than this are sorted by comparison.
const RADIX_FROM: usize = 512;
pub(crate) const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;

/// Sorts keys; `scratch` is overwritten.
pub(crate) fn sort(keys: &mut Vec<u32>, scratch: &mut Vec<u32>) {
    if keys.len() < RADIX_FROM {
        keys.sort_unstable();
        return;
    }
    scratch.clear();
    scratch.resize(keys.len(), 0);
    for pass in 0..3 {
        scatter(keys, scratch, pass * DIGIT_BITS);
        std::mem::swap(keys, scratch);
    }
}

/// Sorts keys by one digit; keys with the same one stay in order.
///
/// # Panics
/// If there are fewer places than keys.
pub(crate) fn scatter(from: &[u32], to: &mut [u32], shift: u32) {
    let digit = |k: u32| (k >> shift) as usize & (DIGITS - 1);
    let mut next = [0u32; DIGITS];
    for &k in from {
        next[digit(k)] += 1;
    }
    let mut start = 0;
    for slot in &mut next {
        start += std::mem::replace(slot, start);
    }
    for &k in from {
        let slot = &mut next[digit(k)];
        to[*slot as usize] = k;
        *slot += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_sort_as_numbers_do() {
        let numbers = [f32::MIN, -1.5, -1e-40, 0.0, 1e-40, 2.0, f32::MAX];
        let mut keys: Vec<u32> = numbers.iter().rev().map(|&x| key(x)).collect();
        keys.sort_unstable();
        assert_eq!(keys.iter().map(|&k| value(k)).collect::<Vec<_>>(), numbers);
        assert_eq!(key(-0.0), key(0.0));
    }

    #[test]
    fn long_lists_sort_like_short_ones() {
        let mut state = 1u32;
        let mut keys: Vec<u32> = (0..5000)
            .map(|_| {
                state = state.wrapping_mul(747796405).wrapping_add(1);
                state
            })
            .collect();
        let mut expected = keys.clone();
        expected.sort_unstable();
        sort(&mut keys, &mut Vec::new());
        assert_eq!(keys, expected);
    }
}
