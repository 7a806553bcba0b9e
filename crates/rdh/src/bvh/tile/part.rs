//! A part of a batch, as one thread casts it: tiles where rays are coherent, single rays elsewhere.

use super::{Choice, Packed, RAYS, Tile};
use crate::bvh::Bvh;
use crate::bvh::leaves::Leaves;
use crate::bvh::trace::Walk;
use crate::geom::Ray;
use crate::simd::{Job, Kernels, LANES};

/// Rays, and where their answers go: as many.
pub(crate) struct Part<'a, C: Packed, L> {
    pub(crate) tree: &'a Bvh<8, L>,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [C::Output],
    /// How many rays a row has, if the rays are rows of a picture.
    pub(crate) width: Option<usize>,
}

impl<C: Packed, L: Leaves> Job for Part<'_, C, L> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(mut self) {
        let mut tile = Tile::<K::Eight>::empty();
        let mut from = 0;
        if let Some(width) = self.width {
            while self.rays.len() - from >= 8 * width {
                for x in (0..width).step_by(8) {
                    self.cast::<K>(&mut tile, &square(from + x, width, (width - x).min(8)));
                }
                from += 8 * width;
            }
        }
        while from < self.rays.len() {
            let count = (self.rays.len() - from).min(RAYS);
            self.cast::<K>(&mut tile, &run(from, count));
            from += count;
        }
    }
}

/// Rays that follow each other.
#[inline(always)]
fn run(from: usize, count: usize) -> Choice {
    let mut choice = Choice::NONE;
    for i in 0..count {
        choice.push((from + i) as u32);
    }
    choice
}

/// Eight rows of up to eight rays, in Morton order, so that packets are compact.
#[inline(always)]
fn square(from: usize, width: usize, columns: usize) -> Choice {
    let mut choice = Choice::NONE;
    for i in 0..RAYS {
        let (x, y) = (i & 1 | i >> 1 & 2 | i >> 2 & 4, i >> 1 & 1 | i >> 2 & 2 | i >> 3 & 4);
        if x < columns {
            choice.push((from + y * width + x) as u32);
        }
    }
    choice
}

/// A tile smaller than this is not worth it.
const FEWEST: usize = LANES;

impl<C: Packed, L: Leaves> Part<'_, C, L> {
    #[inline(always)]
    fn cast<K: Kernels>(&mut self, tile: &mut Tile<K::Eight>, choice: &Choice) {
        if choice.rays().len() >= FEWEST && self.is_coherent(choice) {
            if tile.fill(self.rays, choice, self.tree.magnitude) {
                self.cast_tile::<K>(tile, choice);
                return;
            }
        }
        for &ray in choice.rays() {
            self.cast_one::<K>(ray as usize);
        }
    }

    fn is_coherent(&self, _: &Choice) -> bool {
        self.tree.scale.factor() == 1.0
    }

    #[inline(always)]
    fn cast_tile<K: Kernels>(&mut self, tile: &mut Tile<K::Eight>, choice: &Choice) {
        tile.walk::<K, C, L>(self.tree);
        for (packet, rays) in tile.packets.iter().zip(choice.rays().chunks(LANES)) {
            for (lane, &ray) in rays.iter().enumerate() {
                self.answers[ray as usize] = C::read(packet, lane);
            }
        }
    }

    #[inline(always)]
    fn cast_one<K: Kernels>(&mut self, ray: usize) {
        let walk = Walk::<_, C, L, 8> { tree: self.tree, ray: &self.rays[ray], probe: &mut (), start: () };
        self.answers[ray] = walk.run::<K>();
    }
}
