//! Coherent rays through the tree of eight: tiles of 64, in packets of eight side by side.
//!
//! A tile's rays run in one octant and have one longest axis. The `beam` around them says which children of a node are met at all;
//! a child's own box is tested against the packets when its turn comes. So most nodes cost a tile little more than they cost a ray.
//! What the rays hit is what each would hit alone, bit for bit: see `packet`.

mod beam;
mod choice;
mod coherence;
mod effort;
mod packet;
mod part;
mod sorted;
mod walk;
mod windows;

pub(crate) use part::{Cost, Part};
pub(crate) use windows::Windows;

use crate::geom::{Hit, Ray};
use crate::leaf::{Any, Closest};
use crate::simd::{Eight, LANES};

use beam::Beam;
use choice::Choice;
use effort::Effort;
use packet::{Class, Loaded, Packet, Reach};

/// Packets of a tile.
const PACKETS: usize = 8;
/// Rays of a tile.
const RAYS: usize = PACKETS * LANES;

/// Rays that go through the tree together.
#[derive(Debug, Clone, Copy)]
struct Tile<E> {
    packets: [Packet<E>; PACKETS],
    /// How many packets hold rays.
    count: usize,
    class: Class,
    beam: Beam<E>,
    effort: Effort,
}

/// A query that tiles can answer.
pub(crate) trait Packed: crate::leaf::Collector<Start = ()> {
    /// What is known of a ray when the tile is done.
    fn read<E: Eight>(packet: &Packet<E>, lane: usize) -> Self::Output;
}

impl Packed for Closest {
    #[inline(always)]
    fn read<E: Eight>(packet: &Packet<E>, lane: usize) -> Option<Hit> {
        packet.closest(lane)
    }
}

impl Packed for Any {
    #[inline(always)]
    fn read<E: Eight>(packet: &Packet<E>, lane: usize) -> bool {
        packet.has_hit(lane)
    }
}

impl<E: Eight> Tile<E> {
    /// Without rays.
    #[inline(always)]
    fn empty() -> Self {
        let class = Class::new(0, 0);
        let (packets, beam) = ([Packet::empty(); PACKETS], Beam::new(&Reach::nothing(), class));
        Self { packets, count: 0, class, beam, effort: Effort::default() }
    }

    /// Takes over rays, if they are usual ones of one class.
    #[inline(always)]
    fn fill(&mut self, rays: &[Ray], choice: &Choice, magnitude: f32, masks: bool) -> bool {
        let chosen = choice.rays();
        let Some(&last) = chosen.last() else { return false };
        let count = chosen.len().div_ceil(LANES);
        let mut loaded = [Loaded::<E>::empty(); PACKETS];
        let (mut usual, mut all, mut some) = (0xff, [0xff; 5], [0; 5]);
        for (i, packet) in loaded[..count].iter_mut().enumerate() {
            let ray = |lane: usize| &rays[chosen.get(LANES * i + lane).copied().unwrap_or(last) as usize];
            *packet = Loaded::new([ray(0), ray(1), ray(2), ray(3), ray(4), ray(5), ray(6), ray(7)]);
            usual &= packet.usual();
            let ([x, y, z], [main_x, main_y]) = packet.classes();
            for (bits, (all, some)) in [x, y, z, main_x, main_y].into_iter().zip(all.iter_mut().zip(&mut some)) {
                *all &= bits;
                *some |= bits;
            }
        }
        if usual != 0xff || (0..5).any(|i| all[i] != 0xff && some[i] != 0) {
            return false;
        }
        let down = (all[0] & 1) | (all[1] & 1) << 1 | (all[2] & 1) << 2;
        let main = if all[3] != 0 {
            0
        } else if all[4] != 0 {
            1
        } else {
            2
        };
        self.class = Class::new(down, main);
        self.count = count;
        self.effort = Effort::of(chosen.len());
        let mut reach = Reach::nothing();
        for (i, packet) in self.packets[..count].iter_mut().enumerate() {
            let filled = (chosen.len() - LANES * i).min(LANES);
            packet.fill(&loaded[i], (1 << filled) - 1, self.class, magnitude, &mut reach);
            if masks {
                let chosen = &chosen[LANES * i..];
                packet.see(std::array::from_fn(|lane| chosen.get(lane).map_or(0, |&ray| rays[ray as usize].mask)));
            }
        }
        self.beam = Beam::new(&reach, self.class);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Bvh, BvhSpec, Copies};
    use crate::simd::{Job, Kernels, Level};
    use crate::{BuildOptions, Mesh};

    /// What a tile finds, if it is one.
    struct Alone<'a>(&'a Bvh<8, Copies>, &'a [Ray]);

    impl Job for Alone<'_> {
        type Output = Option<Vec<Option<Hit>>>;

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            let mut tile = Tile::<K::Eight>::empty();
            if !tile.fill(self.1, &Choice::run(0, self.1.len()), self.0.magnitude, false) {
                return None;
            }
            tile.walk::<K, Closest>(&self.0.with_any_leaves());
            let hits = (0..self.1.len()).map(|i| Closest::read(&tile.packets[i / LANES], i % LANES));
            Some(hits.collect())
        }
    }

    /// Triangles side by side, at z = 0 and behind.
    fn tree() -> Bvh<8, Copies> {
        let at = |i: usize| [(i % 20) as f32, (i / 20 % 20) as f32, (i / 400) as f32];
        let corner = |i: usize, c: usize| [0, 1, 2].map(|a| at(i)[a] + if a + 1 == c { 0.9 } else { 0.0 });
        let positions = (0..1200).flat_map(|i| [0, 1, 2].map(|c| corner(i, c))).collect();
        let mesh = Mesh::new(positions, (0..1200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
        Bvh::build(&mesh, &BvhSpec::default(), None, &BuildOptions::default()).unwrap()
    }

    fn fan(count: usize) -> Vec<Ray> {
        let ray = |i: usize| Ray::new([8.3, 7.1, -9.0], [(i % 8) as f32 * 0.02 + 0.01, (i / 8) as f32 * 0.02, 1.0]);
        (0..count).map(ray).collect()
    }

    #[test]
    fn tiles_are_made_and_find_what_rays_find() {
        let tree = tree();
        for count in [1, 7, 8, 9, 40, 64] {
            let rays = fan(count);
            let expected: Vec<_> = rays.iter().map(|ray| tree.closest(ray, &mut ())).collect();
            assert!(count < 40 || expected.iter().flatten().count() > 10);
            for level in Level::available() {
                assert_eq!(level.run(Alone(&tree, &rays)), Some(expected.clone()), "{count}, {}", level.name());
            }
        }
    }

    #[test]
    fn rays_of_several_classes_and_unusual_ones_are_no_tile() {
        let tree = tree();
        let (usual, mut turned, mut long, mut empty) = (fan(64), fan(64), fan(64), fan(64));
        turned[3].direction[0] *= -1.0;
        long[63].direction = long[63].direction.map(|x| x * 1e20);
        empty[17].t_min = f32::NAN;
        let mut steep = fan(64);
        steep[40].direction = [0.1, 2.0, 1.0];
        for level in Level::available() {
            let is_tile = |rays: &[Ray]| level.run(Alone(&tree, rays)).is_some();
            let tiles = [&usual, &turned, &long, &empty, &steep].map(|rays| is_tile(rays));
            assert_eq!(tiles, [true, false, false, false, false], "{}", level.name());
        }
    }
}
