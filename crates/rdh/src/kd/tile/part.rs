//! A part of a batch, as one thread casts it: in tiles where rays are coherent and tiles pay, else one by one.

use crate::geom::Ray;
use crate::kd::KdTree;
use crate::simd::{Job, Kernels};
use crate::tile::{Cost, Others, OthersSlots, Packed, Tiles};

/// Rays, and where their answers go: as many.
pub(crate) struct Part<'a, C: Packed> {
    pub(crate) tree: &'a KdTree,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [C::Output],
    /// How many rays a row has, if the rays are rows of a picture.
    pub(crate) width: Option<usize>,
}

impl<C: Packed> Job for Part<'_, C> {
    type Output = Cost;

    /// One loop, so that tiles are compiled once: all of theirs is inlined here, where the level's instructions are known.
    #[inline(always)]
    fn run<K: Kernels>(self) -> Cost {
        let Self { tree, rays, answers, width } = self;
        let mut tiles = Tiles::<K, _>::new(tree, rays.len(), width);
        let mut slots = OthersSlots::new();
        let mut others = Others::none(&mut slots);
        while !tiles.are_done() {
            tiles.cast::<C>(tree, rays, answers, &mut others);
            for &ray in others.rays() {
                let ray = ray as usize;
                tree.cast::<C>(&rays[ray], &mut (), &mut answers[ray]);
            }
            tiles.cast_otherwise(others.rays().len());
            others.clear();
        }
        tiles.cost()
    }
}
