//! Coherent rays through the tree of eight: tiles of 64, in packets of eight side by side.
//!
//! A tile's rays run in one octant and have one longest axis. The `beam` around them says which children of a node are met at all;
//! a child's own box is tested against the packets when its turn comes. So most nodes cost a tile little more than they cost a ray.
//! What the rays hit is what each would hit alone, bit for bit: see `packet`.

mod beam;
mod choice;
mod coherence;
mod packet;
mod part;
mod walk;

pub(crate) use part::Part;

use crate::geom::{Hit, Ray};
use crate::leaf::{Any, Closest};
use crate::simd::{Eight, LANES};

use beam::Beam;
use choice::Choice;
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
        let class = Class { down: 0, main: 0 };
        Self { packets: [Packet::empty(); PACKETS], count: 0, class, beam: Beam::new(&Reach::nothing(), class) }
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
        let main = if all[3] != 0 { 0 } else if all[4] != 0 { 1 } else { 2 };
        self.class = Class { down, main };
        self.count = count;
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
