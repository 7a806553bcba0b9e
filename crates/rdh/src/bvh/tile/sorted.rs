//! Rays without order, sorted by where they start and which way they go, so that neighbours visit the same nodes.

use crate::geom::{Aabb, Ray};
use crate::mem;
use crate::radix::{DIGIT_BITS, scatter};

/// So many rays are sorted at a time: a key and the ray's number share a word.
pub(super) const MOST: usize = 1 << NUMBER_BITS;
const NUMBER_BITS: u32 = 16;
/// Fewer rays hardly become neighbours.
pub(super) const FEWEST: usize = 1 << 12;
/// The box of where rays start is divided into 2⁴ parts on each axis.
const PLACE_BITS: u32 = 4;
const KEY_BITS: u32 = 3 * PLACE_BITS + 3;
/// So many rays tell how many places there are.
const SAMPLE: usize = 512;
/// So many rays a place make up for the sorting.
const NEIGHBOURS: u64 = 8;

/// The numbers of all rays from one on, at most [`MOST`], in an order in which neighbours start in one place and run in one octant; none
/// if there is no memory for it. O(n).
pub(super) fn sorted(rays: &[Ray], first: usize) -> Option<Vec<u32>> {
    let some = rays.get(first..)?;
    let (mut from, mut to) = (Vec::new(), mem::zeroed(some.len(), "the order of rays").ok()?);
    mem::reserve_all(&mut from, some.len(), "the order of rays").ok()?;
    let bounds = some.iter().fold(Aabb::EMPTY, |bounds, ray| bounds.with(ray.origin));
    from.extend(some.iter().zip(0..).map(|(ray, number): (_, u32)| key(ray, &bounds) << NUMBER_BITS | number));
    // The lowest digit takes some bits of the numbers along, by which they are in order already.
    for shift in [u32::BITS - 2 * DIGIT_BITS, u32::BITS - DIGIT_BITS] {
        scatter(&from, &mut to, shift);
        std::mem::swap(&mut from, &mut to);
    }
    from.iter_mut().for_each(|word| *word = (*word & (MOST as u32 - 1)) + first as u32);
    Some(from)
}

/// Whether sorting so many rays would make neighbours: whether several are expected to start in one place and run in one octant, by how
/// many of a sample do.
pub(super) fn makes_neighbours(rays: &[Ray]) -> bool {
    let step = (rays.len() / SAMPLE).max(1);
    let sample = || rays.iter().step_by(step).take(SAMPLE);
    let bounds = sample().fold(Aabb::EMPTY, |bounds, ray| bounds.with(ray.origin));
    let (mut is_taken, mut alike) = ([0u64; 1 << (KEY_BITS - 6)], 0);
    for ray in sample() {
        let key = key(ray, &bounds) as usize;
        alike += is_taken[key / 64] >> (key % 64) & 1;
        is_taken[key / 64] |= 1 << (key % 64);
    }
    // Of n rays in k places n²/2k are alike, if that is few.
    let places = (SAMPLE * SAMPLE) as u64 / (2 * alike.max(1));
    rays.len() as u64 > NEIGHBOURS * places
}

/// Morton's code of the place, then the octant: 15 bits. What is no number belongs to any place.
#[inline(always)]
fn key(ray: &Ray, bounds: &Aabb) -> u32 {
    const PLACES: f32 = (1 << PLACE_BITS) as f32;
    /// Added to a small number it leaves a whole one in the lowest bits.
    const WHOLE: f32 = (1 << 23) as f32;
    let mut key = 0;
    for a in 0..3 {
        let place = (ray.origin[a] - bounds.min[a]) * (PLACES / (bounds.max[a] - bounds.min[a]));
        let place = (place.clamp(0.0, PLACES - 1.0) + WHOLE).to_bits() & ((1 << PLACE_BITS) - 1);
        key |= spread(place) << (a + 3) | (ray.direction[a].to_bits() >> 31) << a;
    }
    key
}

/// Four bits, three places apart.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | x << 4) & 0xc3;
    (x | x << 2) & 0x249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soup::numbers;

    #[test]
    fn neighbours_start_in_one_place_and_run_in_one_octant() {
        let mut number = numbers(1);
        let mut rays: Vec<Ray> =
            (0..MOST).map(|_| Ray::new([number(), number(), number()], [number(), number(), number()])).collect();
        rays[5] = Ray::new([f32::NAN, f32::INFINITY, -1e30], [f32::NAN, -0.0, 0.0]);
        let order = sorted(&rays, 0).expect("memory");
        let bounds = rays.iter().fold(Aabb::EMPTY, |bounds, ray| bounds.with(ray.origin));
        assert!(order.is_sorted_by_key(|&i| (key(&rays[i as usize], &bounds), i)));
        let mut all = order;
        all.sort_unstable();
        assert!(all.into_iter().eq(0..MOST as u32));
    }

    #[test]
    fn neighbours_are_made_where_many_rays_start_in_few_places() {
        let ray = |i: usize, from: usize| {
            let origin = [1, 7, 49].map(|part| (i * 7919 % from / part % 7) as f32);
            Ray::new(origin, [1.0, if i.is_multiple_of(2) { 1.0 } else { -1.0 }, 1.0])
        };
        let rays = |from| (0..FEWEST).map(|i| ray(i, from)).collect::<Vec<_>>();
        assert!(makes_neighbours(&rays(49)) && !makes_neighbours(&rays(343)));
    }

    #[test]
    fn a_flat_box_and_no_rays_are_fine() {
        assert_eq!(sorted(&[], 0), Some(Vec::new()));
        assert_eq!(sorted(&[Ray::new([0.0; 3], [1.0; 3]); 3], 1), Some(vec![1, 2]));
    }
}
