//! Coherent rays through the tree of eight: tiles of 64, in packets of eight or sixteen side by side.
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
use crate::simd::{Floats, all_lanes};

use beam::Beam;
use choice::Choice;
use effort::Effort;
use packet::{Class, Loaded, Packet, Reach};

/// Rays of a tile.
const RAYS: usize = 64;
/// Packets of a tile, at most: those of eight rays.
const PACKETS: usize = RAYS / 8;

/// Rays that go through the tree together.
#[derive(Debug, Clone, Copy)]
struct Tile<R: Floats> {
    packets: [Packet<R>; PACKETS],
    /// How many packets hold rays.
    count: usize,
    class: Class,
    beam: Beam<R::Eight>,
    effort: Effort,
}

/// A query that tiles can answer.
pub(crate) trait Packed: crate::leaf::Collector<Start = ()> {
    /// What is known of a ray when the tile is done.
    fn read<R: Floats>(packet: &Packet<R>, lane: usize) -> Self::Output;
}

impl Packed for Closest {
    #[inline(always)]
    fn read<R: Floats>(packet: &Packet<R>, lane: usize) -> Option<Hit> {
        packet.closest(lane)
    }
}

impl Packed for Any {
    #[inline(always)]
    fn read<R: Floats>(packet: &Packet<R>, lane: usize) -> bool {
        packet.has_hit(lane)
    }
}

impl<R: Floats> Tile<R> {
    /// Without rays.
    #[inline(always)]
    fn empty() -> Self {
        let class = Class::new(0, 0);
        let (packets, beam) = ([Packet::empty(); PACKETS], Beam::new(&Reach::<R>::nothing(), class));
        Self { packets, count: 0, class, beam, effort: Effort::default() }
    }

    /// Takes over rays, if they are usual ones of one class.
    #[inline(always)]
    fn fill(&mut self, rays: &[Ray], choice: &Choice, magnitude: f32, masks: bool) -> bool {
        let chosen = choice.rays();
        let Some(&last) = chosen.last() else { return false };
        let count = chosen.len().div_ceil(R::COUNT);
        let mut loaded = [Loaded::<R>::empty(); PACKETS];
        let lanes = all_lanes::<R>();
        let (mut usual, mut all, mut some) = (lanes, [lanes; 5], [0; 5]);
        for (i, packet) in loaded[..count].iter_mut().enumerate() {
            let ray = |lane: usize| &rays[chosen.get(R::COUNT * i + lane).copied().unwrap_or(last) as usize];
            *packet = Loaded::new(ray);
            usual &= packet.usual();
            let ([x, y, z], [main_x, main_y]) = packet.classes();
            for (bits, (all, some)) in [x, y, z, main_x, main_y].into_iter().zip(all.iter_mut().zip(&mut some)) {
                *all &= bits;
                *some |= bits;
            }
        }
        if usual != lanes || (0..5).any(|i| all[i] != lanes && some[i] != 0) {
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
            let filled = (chosen.len() - R::COUNT * i).min(R::COUNT);
            packet.fill(&loaded[i], (1 << filled) - 1, self.class, magnitude, &mut reach);
            if masks {
                let chosen = &chosen[R::COUNT * i..];
                packet.see(|lane| chosen.get(lane).map_or(0, |&ray| rays[ray as usize].mask));
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
    use crate::simd::{Job, Kernels, Level, Two};
    use crate::{BuildOptions, Mesh};

    /// What a tile finds, if it is one: in packets as the level has them, and in those of eight and of sixteen rays.
    struct Alone<'a>(&'a Bvh<8, Copies>, &'a [Ray]);

    impl Job for Alone<'_> {
        type Output = [Option<Vec<Option<Hit>>>; 3];

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            [self.find::<K, K::Rays>(), self.find::<K, K::Eight>(), self.find::<K, Two<K::Eight>>()]
        }
    }

    impl Alone<'_> {
        #[inline(always)]
        fn find<K: Kernels, R: Floats<Eight = K::Eight>>(&self) -> Option<Vec<Option<Hit>>> {
            let masks = self.0.masks.is_some();
            let mut tile = Tile::<R>::empty();
            if !tile.fill(self.1, &Choice::run(0, self.1.len()), self.0.magnitude, masks) {
                return None;
            }
            tile.walk::<K, Closest>(&self.0.with_any_leaves());
            let hits: Vec<_> =
                (0..self.1.len()).map(|i| Closest::read(&tile.packets[i / R::COUNT], i % R::COUNT)).collect();
            assert!(tile.fill(self.1, &Choice::run(0, self.1.len()), self.0.magnitude, masks));
            tile.walk::<K, Any>(&self.0.with_any_leaves());
            let any = (0..self.1.len()).map(|i| Any::read(&tile.packets[i / R::COUNT], i % R::COUNT));
            assert!(any.eq(hits.iter().map(Option::is_some)), "any hit is found where the nearest one is");
            Some(hits)
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
                let found = level.run(Alone(&tree, &rays));
                assert_eq!(found, [0; 3].map(|_| Some(expected.clone())), "{count}, {}", level.name());
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
            let is_tile = |rays: &[Ray]| level.run(Alone(&tree, rays)).iter().all(Option::is_some);
            let tiles = [&usual, &turned, &long, &empty, &steep].map(|rays| is_tile(rays));
            assert_eq!(tiles, [true, false, false, false, false], "{}", level.name());
        }
    }
}
