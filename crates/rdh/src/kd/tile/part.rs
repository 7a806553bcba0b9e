//! A part of a batch, as one thread casts it: in tiles where rays are coherent and tiles pay, else one by one.

use super::Bundle;
use crate::geom::Ray;
use crate::kd::KdTree;
use crate::kd::trace::Walk;
use crate::simd::{Job, Kernels};
use crate::tile::{Choices, Cost, Next, Others, OthersSlots, Packed};

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
        let has_tiles = K::PACKETS && tree.scale.factor() == 1.0;
        let mut choices = Choices::new(rays.len(), width, &tree.bounds, has_tiles);
        // None before the first tile: small batches would take long to make one ready.
        let (mut bundle, about) = (None::<Bundle<K::Rays>>, (tree.magnitude, tree.masks.is_some()));
        let mut slots = OthersSlots::new();
        let (mut cost, mut others) = (Cost::default(), Others::none(&mut slots));
        loop {
            let next = choices.next(rays);
            let is_end = matches!(next, Next::End);
            match next {
                Next::End => {}
                Next::Others(choice) => others.add(choice.rays()),
                // There are none: this spares the program their code.
                Next::Tile(choice) if !K::PACKETS => others.add(choice.rays()),
                Next::Tile(choice) => {
                    if bundle.is_none() {
                        bundle = Some(Bundle::empty());
                    }
                    let Some(bundle) = &mut bundle else { return cost };
                    if bundle.fill(rays, &choice, about) {
                        if bundle.walk::<C>(tree) {
                            bundle.tile.read::<C>(choice.rays(), answers);
                        } else {
                            bundle.tile.read_settled::<C>(choice.rays(), answers, &mut others);
                        }
                        choices.has_paid(bundle.effort.has_paid());
                        cost.cycles += bundle.effort.cycles();
                    } else if let Some(choice) = choices.failed(choice) {
                        others.add(choice.rays());
                    }
                }
            }
            if is_end || others.are_enough() {
                cost.others += others.rays().len();
                for &ray in others.rays() {
                    let ray = ray as usize;
                    answers[ray] = tree.level.run(Walk::<_, C> { tree, ray: &rays[ray], probe: &mut (), start: () });
                }
                others.clear();
            }
            if is_end {
                return cost;
            }
        }
    }
}
