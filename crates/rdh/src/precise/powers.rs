//! Powers of two: scaling without rounding.

/// The smallest power of two that is larger, by its exponent; 0 for 0.
pub(super) fn exponent_above(x: f64) -> i32 {
    if x == 0.0 {
        return 0;
    }
    let exponent = (x.to_bits() >> 52 & 0x7ff) as i32;
    let of_fraction = |bits: u64| -1074 + (64 - bits.leading_zeros() as i32);
    if exponent == 0 { of_fraction(x.to_bits()) } else { exponent - 1022 }
}

/// `x · 2^exponent`: exact, unless it leaves the range of numbers.
pub(super) fn times_power(x: f64, exponent: i32) -> f64 {
    let power = |e: i32| f64::from_bits(((1023 + e) as u64) << 52);
    // In steps that are numbers; those that go one way can't go wrong on the way.
    let mut left = exponent.clamp(-4000, 4000);
    let mut x = x;
    while left != 0 {
        let step = left.clamp(-1000, 1000);
        x *= power(step);
        left -= step;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_exact() {
        for (x, exponent, expected) in [(3.0, -1, 1.5), (f64::from_bits(1), 1074, 1.0), (1e300, 2000, f64::INFINITY)] {
            assert_eq!(times_power(x, exponent), expected);
        }
        for x in [1.0, 1.5, 0.75, 1e-310, f64::MAX, f64::from_bits(1)] {
            let above = exponent_above(x);
            assert!((0.5..1.0).contains(&times_power(x, -above)), "{x:e}");
        }
    }
}
