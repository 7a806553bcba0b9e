//! Coherent rays that walk together: tiles of 64 at most, in packets of eight or sixteen side by side.
//!
//! ```text
//! a batch --windows, coherence--> choices of up to 64 rays --fill--> a tile of one class: packets, and what they reach
//!     --walk through bvh/ or kd/--> hits, bit for bit those of each ray alone
//! ```
//! A tile's rays run in one octant and have one longest axis. How it walks is each kind of tree's own; what a packet asks of boxes and
//! triangles, and which rays make a tile, is here.

mod batched;
mod bundle;
mod choice;
mod choices;
mod coherence;
mod cost;
mod effort;
mod interval;
mod others;
mod packet;
mod patience;
mod tiles;
mod windows;

pub(crate) use batched::Batched;
pub(crate) use bundle::{Bundle, Lead, Reaches, Space, Tiled};
pub(crate) use choice::Choice;
pub(crate) use coherence::are_unordered;
pub(crate) use cost::Cost;
pub(crate) use effort::{Effort, Prices};
pub(crate) use interval::Interval;
pub(crate) use others::{Others, OthersSlots};
pub(crate) use packet::{Class, Leaf, Packet, Planes, Reach};
pub(crate) use tiles::Tiles;
pub(crate) use windows::Windows;

use crate::geom::{Hit, Ray};
use crate::leaf::{Any, Closest, Collector};
use crate::simd::{Floats, all_lanes};

use packet::Loaded;

/// Rays of a tile.
pub(crate) const RAYS: usize = 64;
/// Packets of a tile, at most: those of eight rays.
pub(crate) const PACKETS: usize = RAYS / 8;

/// Rays that go through a tree together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile<R> {
    pub(crate) packets: [Packet<R>; PACKETS],
    /// How many packets hold rays.
    pub(crate) count: usize,
    pub(crate) class: Class,
}

/// A query that tiles can answer.
pub(crate) trait Packed: Collector<Start = ()> {
    /// What is known of a ray when the tile is done.
    fn read<R: Floats>(packet: &Packet<R>, lane: usize) -> Self::Output;

    /// Whether that is known before the tile is done.
    fn is_settled<R: Floats>(packet: &Packet<R>, lane: usize) -> bool;
}

impl Packed for Closest {
    #[inline(always)]
    fn read<R: Floats>(packet: &Packet<R>, lane: usize) -> Option<Hit> {
        packet.closest(lane)
    }

    #[inline(always)]
    fn is_settled<R: Floats>(_: &Packet<R>, _: usize) -> bool {
        false
    }
}

impl Packed for Any {
    #[inline(always)]
    fn read<R: Floats>(packet: &Packet<R>, lane: usize) -> bool {
        packet.has_hit(lane)
    }

    #[inline(always)]
    fn is_settled<R: Floats>(packet: &Packet<R>, lane: usize) -> bool {
        packet.has_hit(lane)
    }
}

impl<R: Floats> Tile<R> {
    /// Without rays.
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        Self { packets: [Packet::empty(); PACKETS], count: 0, class: Class::new(0, 0) }
    }

    /// Takes over rays, if they are usual ones of one class; what they reach is then widened by them.
    #[inline(always)]
    pub(crate) fn fill(&mut self, rays: &[Ray], choice: &Choice, space: &Space, reaches: &mut impl Reaches<R>) -> bool {
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
        for (i, packet) in self.packets[..count].iter_mut().enumerate() {
            let filled = (chosen.len() - R::COUNT * i).min(R::COUNT);
            packet.fill(&loaded[i], (1 << filled) - 1, self.class, space.magnitude, reaches.of_packet(i));
            if space.has_masks {
                let chosen = &chosen[R::COUNT * i..];
                packet.see(|lane| chosen.get(lane).map_or(0, |&ray| rays[ray as usize].mask));
            }
        }
        true
    }

    /// Writes down what its rays have found.
    #[inline(always)]
    pub(crate) fn read<C: Packed>(&self, which: &[u32], answers: &mut [C::Output]) {
        for (packet, rays) in self.packets.iter().zip(which.chunks(R::COUNT)) {
            for (lane, &ray) in rays.iter().enumerate() {
                answers[ray as usize] = C::read(packet, lane);
            }
        }
    }

    /// The same for a tile that was given up: rays of which nothing is settled are others.
    #[inline(always)]
    pub(crate) fn read_settled<C: Packed>(&self, which: &[u32], answers: &mut [C::Output], others: &mut Others<'_>) {
        for (packet, rays) in self.packets.iter().zip(which.chunks(R::COUNT)) {
            for (lane, &ray) in rays.iter().enumerate() {
                if C::is_settled(packet, lane) {
                    answers[ray as usize] = C::read(packet, lane);
                } else {
                    others.add(&[ray]);
                }
            }
        }
    }
}
