//! Rays of a picture, row by row: seen from where neighbours jump.

use crate::geom::{Ray, Vec3};

/// Rows of equal length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rows {
    /// Rays in a row.
    pub(super) width: usize,
    /// Rays before the first whole row.
    pub(super) lead: usize,
}

/// So many rays tell how far neighbours are apart.
const FIRST: usize = 16;
/// Rows longer than this are not found, …
const LONGEST: usize = 1 << 14;
/// … nor fewer than so many: squares have as many.
const FEWEST: usize = 8;
/// Neighbours that are so many times as far apart as usual are none.
const JUMP: f32 = 8.0;
/// So many pairs are looked at, …
const PAIRS: usize = 16;
/// … and so many of them must lie below each other: surfaces have edges.
const BELOW: usize = 12;

/// The rows, if the rays are those of a picture's pixels, one row after the other.
pub(super) fn find(rays: &[Ray]) -> Option<Rows> {
    if rays.len() < FEWEST * FIRST {
        return None;
    }
    let usual = rays[..FIRST].windows(2).fold(Apart::least(&rays[0]), |most, pair| most.or(&Apart::of(pair)));
    // Rays that turn so much from one to the next are no picture's.
    if usual.turn > 0.1 * size(rays[0].direction) {
        return None;
    }
    let jumps = |pair: &[Ray]| Apart::of(pair).is_beyond(&usual);
    let end = |from: usize| {
        let some = rays[from..].windows(2).take(LONGEST.min(rays.len() / FEWEST));
        some.enumerate().find(|(_, pair)| jumps(pair)).map(|(i, _)| from + i + 1)
    };
    let first = end(0)?;
    let second = end(first)?;
    let width = second - first;
    if width < FIRST {
        return None;
    }
    let span = rays.len() - width;
    let is_below = |k: usize| {
        let [ray, beside, below] = [0, width / 2, width].map(|further| &rays[span * k / PAIRS + further]);
        Apart::of(&[*ray, *below]).is_within_half(&Apart::of(&[*ray, *beside]), ray)
    };
    let count = (0..PAIRS).filter(|&k| is_below(k)).count();
    (count >= BELOW).then_some(Rows { width, lead: first % width })
}

/// How far two rays are apart.
#[derive(Debug, Clone, Copy)]
struct Apart {
    turn: f32,
    shift: f32,
}

impl Apart {
    fn of(pair: &[Ray]) -> Self {
        let [a, .., b] = pair else { return Self { turn: 0.0, shift: 0.0 } };
        let difference = |a: Vec3, b: Vec3| size([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
        Self { turn: difference(a.direction, b.direction), shift: difference(a.origin, b.origin) }
    }

    /// What rounding may do.
    fn least(ray: &Ray) -> Self {
        Self { turn: 1e-6 * size(ray.direction), shift: 1e-6 * size(ray.origin) }
    }

    fn or(self, other: &Self) -> Self {
        Self { turn: self.turn.max(other.turn), shift: self.shift.max(other.shift) }
    }

    /// Whether this is at most half as much, but for rounding.
    fn is_within_half(&self, other: &Self, ray: &Ray) -> bool {
        let least = Self::least(ray);
        self.turn <= 0.5 * other.turn + least.turn && self.shift <= 0.5 * other.shift + least.shift
    }

    /// Whether this is much more than usual, or no number.
    fn is_beyond(&self, usual: &Self) -> bool {
        !(self.turn <= JUMP * usual.turn && self.shift <= JUMP * usual.shift)
    }
}

fn size([x, y, z]: Vec3) -> f32 {
    x.abs().max(y.abs()).max(z.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soup::numbers;

    /// Rays through the pixels of a picture, row by row.
    fn picture(width: usize, height: usize) -> Vec<Ray> {
        let at = |i: usize, n: usize| (i as f32 + 0.5) / n as f32 - 0.5;
        let ray = |i: usize| Ray::new([1.0, 2.0, 3.0], [at(i % width, width), at(i / width, width), 1.0]);
        (0..width * height).map(ray).collect()
    }

    #[test]
    fn rows_are_found_wherever_a_batch_begins() {
        let rays = picture(100, 60);
        assert_eq!(find(&rays), Some(Rows { width: 100, lead: 0 }));
        assert_eq!(find(&rays[30..]), Some(Rows { width: 100, lead: 70 }));
        assert_eq!(find(&rays[..850]), Some(Rows { width: 100, lead: 0 }));
        assert_eq!(find(&picture(17, 40)), Some(Rows { width: 17, lead: 0 }));
        let parallel: Vec<Ray> = rays.iter().map(|ray| Ray::new(ray.direction, [0.0, 0.0, 1.0])).collect();
        assert_eq!(find(&parallel), Some(Rows { width: 100, lead: 0 }));
    }

    #[test]
    fn what_is_no_picture_has_no_rows() {
        let mut rays = picture(64, 64);
        for count in [0, 1, 15, 63, 64, 100] {
            assert_eq!(find(&rays[..count]), None, "{count}");
        }
        // In squares of eight by eight, one after the other.
        let square = |i: usize| rays[(i / 512 * 8 + i / 8 % 8) * 64 + i / 64 % 8 * 8 + i % 8];
        assert_eq!(find(&(0..4096).map(square).collect::<Vec<_>>()), None);
        let scattered: Vec<Ray> = (0..4096).map(|i| rays[i * 1663 % 4096]).collect();
        assert_eq!(find(&scattered), None);
        assert_eq!(find(&vec![rays[0]; 1000]), None);
        // Towards the sun, from leaves here and there, and now and then from far behind them.
        let mut number = numbers(1);
        let mut depth = |i: usize| if i.is_multiple_of(16) && number() > 0.5 { 30.0 } else { number() };
        let leaves: Vec<Ray> =
            (0..4096).map(|i| Ray::new([i as f32 * 0.01, 0.0, depth(i + 1)], [0.1, 0.2, 1.0])).collect();
        assert_eq!(find(&leaves), None);
        rays.iter_mut().for_each(|ray| ray.direction[0] = f32::NAN);
        assert_eq!(find(&rays), None);
    }
}
