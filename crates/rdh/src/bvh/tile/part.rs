//! A part of a batch, as one thread casts it: in tiles where rays are coherent, by turns where they have no order, else one by one.

use super::coherence::Extent;
use super::effort::Patience;
use super::{Choice, Packed, RAYS, Tile};
use crate::bvh::Bvh;
use crate::bvh::leaves::AnyLeaves;
use crate::bvh::recent::Recent;
use crate::bvh::strands;
use crate::bvh::trace::Walk;
use crate::geom::Ray;
use crate::simd::{Eight, Job, Kernels, LANES};

/// Rays, and where their answers go: as many.
pub(crate) struct Part<'a, C: Packed> {
    pub(crate) tree: &'a Bvh<8, AnyLeaves>,
    /// Whether it is so large that rays without order may wait for memory.
    pub(crate) is_large: bool,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [C::Output],
    /// How many rays a row has, if the rays are rows of a picture.
    pub(crate) width: Option<usize>,
}

impl<C: Packed> Job for Part<'_, C> {
    type Output = ();

    /// One loop, so that each way of casting is compiled once: all is inlined here, where the level's instructions are known.
    #[inline(always)]
    fn run<K: Kernels>(mut self) {
        let (extent, masks) = (Extent::of(&self.tree.bounds), self.tree.masks.is_some());
        let has_tiles = K::PACKETS && self.tree.scale.factor() == 1.0;
        let mut tile = Tile::<K::Eight>::empty();
        let mut others = Others { rays: [0; OTHERS], count: 0 };
        let mut windows = Windows { from: 0, column: 0, width: self.width.unwrap_or(0), count: self.rays.len() };
        let (mut patience, mut mixed) = (Patience::default(), None::<Choice>);
        let mut turns_pay = if self.is_large { None } else { Some(false) };
        let mut done = false;
        while !done {
            let is_class = mixed.is_some();
            let choice = match mixed.take() {
                Some(choice) => {
                    let (class, rest) = choice.first_class(self.rays);
                    mixed = (!rest.rays().is_empty()).then_some(rest);
                    class
                }
                None => windows.next(),
            };
            let which = choice.rays();
            let may = has_tiles && which.len() >= FEWEST;
            let suits = may && (is_class || extent.is_coherent(self.rays, which) && patience.tries());
            if suits && tile.fill(self.rays, &choice, self.tree.magnitude, masks) {
                tile.walk::<K, C>(self.tree);
                self.read(&tile, which);
                patience.note(tile.effort.has_paid());
            } else if suits && !is_class {
                mixed = Some(choice);
            } else {
                others.rays[others.count..][..which.len()].copy_from_slice(which);
                others.count += which.len();
            }
            done = mixed.is_none() && which.is_empty();
            if done || others.count > OTHERS - RAYS {
                self.cast_others::<K>(&others.rays[..others.count], extent, &mut turns_pay);
                others.count = 0;
            }
        }
    }
}

/// Rays that make no tile wait here until there are enough of them to take turns.
struct Others {
    rays: [u32; OTHERS],
    count: usize,
}

/// So many rays wait, so that few turns are left empty at their end.
const OTHERS: usize = 16 * RAYS;
/// A structure up to this size stays in a core's caches or nearly, and nothing is tried out.
pub(crate) const LARGE: usize = 2 << 20;
/// So many rays try out whether turns pay.
const SAMPLE: usize = 256;
/// A tile of fewer rays is not worth it.
const FEWEST: usize = 2 * LANES;

impl<C: Packed> Part<'_, C> {
    /// Writes down what a tile's rays have found.
    #[inline(always)]
    fn read<E: Eight>(&mut self, tile: &Tile<E>, which: &[u32]) {
        for (packet, rays) in tile.packets.iter().zip(which.chunks(LANES)) {
            for (lane, &ray) in rays.iter().enumerate() {
                self.answers[ray as usize] = C::read(packet, lane);
            }
        }
    }

    /// Rays without order take turns where they wait for memory, which their first ones try out; elsewhere turns cost a quarter.
    #[inline(always)]
    fn cast_others<K: Kernels>(&mut self, which: &[u32], extent: Extent, turns_pay: &mut Option<bool>) {
        let is_unordered = *turns_pay != Some(false) && extent.is_unordered(self.rays, which);
        let mut recent = (is_unordered && turns_pay.is_none()).then(Recent::nothing);
        let (sample, rest) = which.split_at(recent.as_ref().map_or(0, |_| SAMPLE.min(which.len())));
        for which in [sample, rest] {
            if is_unordered && *turns_pay != Some(false) {
                let answers = &mut *self.answers;
                let done = |ray, answer| answers[ray as usize] = answer;
                strands::cast::<K, C>(self.tree, self.rays, which, recent.as_mut(), done);
                *turns_pay = turns_pay.or(recent.take().map(|recent| recent.waits()));
            } else {
                self.cast_one_by_one::<K>(which);
            }
        }
    }

    #[inline(always)]
    fn cast_one_by_one<K: Kernels>(&mut self, which: &[u32]) {
        for &ray in which {
            let ray = ray as usize;
            let walk = Walk::<_, C, AnyLeaves, 8> { tree: self.tree, ray: &self.rays[ray], probe: &mut (), start: () };
            self.answers[ray] = walk.run::<K>();
        }
    }
}

/// What may become tiles, one after the other: squares of rows as long as there are eight of them, then runs.
struct Windows {
    from: usize,
    column: usize,
    /// 0 if there are no rows.
    width: usize,
    count: usize,
}

impl Windows {
    /// The next rays; none at the end.
    #[inline(always)]
    fn next(&mut self) -> Choice {
        if self.width > 0 && self.count - self.from >= 8 * self.width {
            let column = self.column;
            let choice = Choice::square(self.from + column, self.width, (self.width - column).min(8));
            self.column = column + 8;
            if self.column >= self.width {
                (self.column, self.from) = (0, self.from + 8 * self.width);
            }
            return choice;
        }
        let choice = Choice::run(self.from, self.count - self.from);
        self.from += choice.rays().len();
        choice
    }
}
