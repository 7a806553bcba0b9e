//! `a·b − c·d` with the right sign, always, and nearly all of its bits.
//!
//! Products and sums are split into what is rounded and what rounding leaves over (T. J. Dekker, *A Floating-Point Technique for
//! Extending the Available Precision*, Numerische Mathematik 18, 1971), by plain operations, so that all machines agree.

use std::cmp::Ordering;

/// `a·b − c·d`, wrong by less than 2⁻⁵⁰ of itself, and of the exact sign, zero included. No number is larger than 2.
///
/// Where products underflow the sign is exact, and the size at least right to a few bits of the rounded difference.
pub(super) fn determinant(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, q) = (a * b, c * d);
    if is_split(p, a, b) && is_split(q, c, d) {
        return difference(a, b, c, d);
    }
    match compare(a, b, c, d) {
        Ordering::Equal => 0.0,
        Ordering::Greater => (p - q).max(f64::MIN_POSITIVE),
        Ordering::Less => (p - q).min(-f64::MIN_POSITIVE),
    }
}

/// The sign of `a·b − c·d`: -1, 0 or 1. No number is larger than 2.
pub(super) fn sign(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, q) = (a * b, c * d);
    let difference = p - q;
    // Each product is wrong by 2⁻⁵³ of itself at most, or by what underflows; so is the difference.
    if difference.abs() > (p.abs() + q.abs()) * SURE + UNDERFLOW {
        return difference.signum();
    }
    let exact = determinant(a, b, c, d);
    if exact == 0.0 { 0.0 } else { exact.signum() }
}

/// More than 2 · 2⁻⁵³: two roundings, and what is neglected.
const SURE: f64 = 1.0 / (1u64 << 50) as f64;
/// More than what two products lose.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;
/// Products that are not smaller leave over what is a number, too.
const SPLIT: f64 = f64::from_bits((1023 - 900) << 52);

/// Whether a product is exact once it is split.
fn is_split(product: f64, a: f64, b: f64) -> bool {
    product.abs() >= SPLIT || a == 0.0 || b == 0.0
}

fn difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let ((p, p_rest), (q, q_rest)) = (product(a, b), product(c, d));
    // If `p` and `q` are near each other their difference is exact; if not it is larger than all that follows.
    let (high, high_rest) = sum(p, -q);
    let (low, low_rest) = sum(p_rest, -q_rest);
    let (first, second) = sum(high, low);
    first + (second + (high_rest + low_rest))
}

/// `a + b`, rounded, and what that leaves over (D. E. Knuth, *The Art of Computer Programming* 2, 4.2.2).
fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let of_b = s - a;
    (s, (a - (s - of_b)) + (b - of_b))
}

/// `a · b`, rounded, and what that leaves over.
fn product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    (p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// A number as the sum of two with half as many bits (G. W. Veltkamp, 1968).
fn halves(x: f64) -> (f64, f64) {
    let big = x * ((1u64 << 27) + 1) as f64;
    let high = big - (big - x);
    (high, x - high)
}

/// How `a·b` compares with `c·d`, in whole numbers: whatever their exponents are. All are finite.
fn compare(a: f64, b: f64, c: f64, d: f64) -> Ordering {
    let ((p_sign, p), (q_sign, q)) = (whole(a, b), whole(c, d));
    match (p_sign, q_sign) {
        (1, 1) => size(p, q),
        (-1, -1) => size(q, p),
        _ => p_sign.cmp(&q_sign),
    }
}

/// A product's sign, its digits with the first of 128 bits set, and the exponent of the last of them.
fn whole(a: f64, b: f64) -> (i32, (u128, i32)) {
    let ((a_digits, a_exponent), (b_digits, b_exponent)) = (digits(a), digits(b));
    let all = u128::from(a_digits) * u128::from(b_digits);
    if all == 0 {
        return (0, (0, 0));
    }
    let shift = all.leading_zeros();
    let sign = if a.is_sign_negative() == b.is_sign_negative() { 1 } else { -1 };
    (sign, (all << shift, a_exponent + b_exponent - shift as i32))
}

/// A number's digits as a whole number, and the exponent of the last.
fn digits(x: f64) -> (u64, i32) {
    let (exponent, fraction) = ((x.to_bits() >> 52 & 0x7ff) as i32, x.to_bits() & ((1 << 52) - 1));
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

fn size((p, p_exponent): (u128, i32), (q, q_exponent): (u128, i32)) -> Ordering {
    p_exponent.cmp(&q_exponent).then(p.cmp(&q))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let bits = state ^ state >> 29;
            // 1 to 2, of either sign, with few digits as often as with many.
            let digits = if bits & 1 == 0 { bits >> 12 } else { bits >> 12 & !0 << 40 };
            f64::from_bits(1023 << 52 | digits & ((1 << 52) - 1)) * if bits & 2 == 0 { 1.0 } else { -1.0 }
        }
    }

    fn signum(order: Ordering) -> f64 {
        f64::from(order as i8)
    }

    #[test]
    fn signs_are_those_of_whole_numbers() {
        let mut number = numbers();
        let (mut close, mut equal) = (0, 0);
        for i in 0..200_000 {
            let (a, b, c) = (number(), number(), number());
            // As near as can be, or equal: where a rounded difference is wrong.
            let d = match i % 4 {
                0 => number(),
                1 => a * b / c,
                2 => (a * b / c).next_up(),
                _ => b,
            };
            let c = if i % 4 == 3 { a } else { c };
            let expected = signum(compare(a, b, c, d));
            assert_eq!(sign(a, b, c, d), expected, "{a:e} {b:e} {c:e} {d:e}");
            let det = determinant(a, b, c, d);
            assert_eq!(if det == 0.0 { 0.0 } else { det.signum() }, expected, "{a:e} {b:e} {c:e} {d:e}");
            close += usize::from(expected != 0.0 && a * b - c * d == 0.0);
            equal += usize::from(expected == 0.0);
        }
        assert!(close > 10_000 && equal > 10_000, "{close} {equal}");
    }

    #[test]
    fn what_underflows_keeps_its_sign() {
        let tiny = f64::from_bits(3);
        let small = 1e-160;
        for (a, b, c, d, expected) in [
            (tiny, tiny, tiny, tiny, 0.0),
            (tiny, f64::from_bits(4), tiny, tiny, 1.0),
            (tiny, -tiny, tiny, tiny, -1.0),
            (small, small, small, small.next_up(), -1.0),
            (0.0, 1.0, tiny, tiny, -1.0),
            (0.0, 1.0, -0.0, tiny, 0.0),
            (1.0, tiny, 0.5, tiny, 1.0),
        ] {
            assert_eq!(sign(a, b, c, d), expected, "{a:e} {b:e} {c:e} {d:e}");
            assert_eq!(sign(c, d, a, b), 0.0 - expected);
            assert_eq!(determinant(a, b, c, d) > 0.0, expected > 0.0);
            assert_eq!(determinant(a, b, c, d) < 0.0, expected < 0.0);
        }
    }

    #[test]
    fn differences_have_nearly_all_bits() {
        // (1 + e)(1 − e) − 1·1 = −e².
        let e = f64::from_bits((1023 - 40) << 52);
        assert_eq!(determinant(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
        // (2 − e)(1 + e) − 2·1 = e − e².
        let found = determinant(2.0 - e, 1.0 + e, 2.0, 1.0);
        assert!((found / (e - e * e) - 1.0).abs() < 1e-15, "{found:e}");
    }
}
