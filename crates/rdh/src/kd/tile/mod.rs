//! Coherent rays through the kd-tree, in tiles of 64.
//!
//! Packets as in I. Wald: Realtime Ray Tracing and Interactive Global Illumination, dissertation, 2004, section 7.2, but a beam around each
//! packet walks in its place (as in A. Reshetov, A. Soupikov, J. Hurley: Multi-Level Ray Tracing Algorithm, SIGGRAPH 2005), the beams of
//! all packets side by side: a node costs a tile little more than it costs a ray. The rays themselves are asked at leaves alone, which of
//! them meets the cell.

mod beams;
mod part;
mod walk;

pub(super) use part::Part;

use crate::kd::KdTree;
use crate::simd::{Floats, Kernels};
use crate::tile::{Bundle, Packed, Prices, Space, Tiled};

use beams::Beams;

/// What it costs: fitted to 12,604 groups of 16 tiles that were cast both ways, in eight scenes, by SAH and RDH, rows, shadows, AO and
/// bounces: 4 % of them are judged wrongly, which costs 0.4 % of the time (Zen 3); in units of the hierarchies'.
pub(crate) struct Costs;

impl Prices for Costs {
    const READY: u32 = 44;
    const NODE: u32 = 96;
    const BOX: u32 = 105;
    const SIFT: u32 = 40;
    const RAY: u32 = 105;
    const PACKET_ALONE: u32 = 52;
    const TEST_ALONE: u32 = 79;
    const COUNTED_RAY: u64 = 105;
    const COUNTED_NODE: u64 = 13;
    const COUNTED_LEAF: u64 = 79;
}

impl Tiled for KdTree {
    type Lead<R: Floats> = Beams<R::Eight>;
    type Costs = Costs;

    fn space(&self) -> Space {
        let Self { scale, bounds, magnitude, ref masks, .. } = *self;
        Space { scale, bounds, magnitude, has_masks: masks.is_some() }
    }

    #[inline(always)]
    fn walk<K: Kernels, C: Packed>(&self, bundle: &mut Bundle<K::Rays, Self>) -> bool {
        bundle.walk::<C>(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Hit, Ray, Vec3};
    use crate::heuristic::Sah;
    use crate::kd::KdSpec;
    use crate::leaf::{Any, Closest};
    use crate::simd::{Job, Level, Two};
    use crate::soup::{numbers, soup};
    use crate::tile::Choice;
    use crate::{BuildOptions, Mesh};

    /// What a tile finds, if it is one: in packets as the level has them, and in those of eight and of sixteen rays.
    struct Alone<'a>(&'a KdTree, &'a [Ray]);

    impl Job for Alone<'_> {
        type Output = [Option<Vec<Option<Hit>>>; 3];

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            [self.find::<K::Rays>(), self.find::<K::Eight>(), self.find::<Two<K::Eight>>()]
        }
    }

    impl Alone<'_> {
        #[inline(always)]
        fn find<R: Floats>(&self) -> Option<Vec<Option<Hit>>> {
            let (space, choice) = (self.0.space(), Choice::run(0, self.1.len()));
            let mut bundle = Bundle::<R, _>::empty();
            if !bundle.fill(self.1, &choice, &space) {
                return None;
            }
            if !bundle.walk::<Closest>(self.0) {
                return None;
            }
            let (mut hits, mut any) = (vec![None; self.1.len()], vec![false; self.1.len()]);
            bundle.tile.read::<Closest>(choice.rays(), &mut hits);
            assert!(bundle.fill(self.1, &choice, &space));
            if !bundle.walk::<Any>(self.0) {
                return Some(hits);
            }
            bundle.tile.read::<Any>(choice.rays(), &mut any);
            assert!(
                any.iter().copied().eq(hits.iter().map(Option::is_some)),
                "any hit is found where the nearest one is"
            );
            Some(hits)
        }
    }

    fn tree(mesh: &Mesh) -> KdTree {
        KdTree::build(mesh, &KdSpec::default(), &Sah, &BuildOptions::default()).expect("it builds")
    }

    /// Rays of one octant: from about a point, into a narrow cone or a wide one.
    fn fan(count: usize, [origin, toward]: [Vec3; 2], spread: f32, number: &mut impl FnMut() -> f32) -> Vec<Ray> {
        let mut beside = |at: Vec3, by: f32| at.map(|x| x + by * number());
        (0..count)
            .map(|_| {
                let direction = beside(toward, spread);
                let same = |a: usize| direction[a].abs().copysign(toward[a]);
                Ray::new(beside(origin, 0.1 * spread), [same(0), same(1), same(2)])
            })
            .collect()
    }

    #[test]
    fn tiles_find_what_rays_find() {
        let mut number = numbers(3);
        let mesh = soup(3_000, 0.1);
        let masks = (0..mesh.len() as u32).map(|i| 1 << (i % 3)).collect();
        let (tree, masked) = (tree(&mesh), tree(&mesh.with_masks(masks).expect("a mask a triangle")));
        let (mut hits, mut tiles) = (0, 0);
        for count in [1, 7, 8, 9, 40, 64] {
            for spread in [0.0, 0.01, 0.1, 0.4] {
                for _ in 0..12 {
                    let place = [[number(), number(), number()], [number(), number(), number()]];
                    let mut rays = fan(count, place, spread, &mut number);
                    rays.iter_mut().enumerate().for_each(|(i, ray)| ray.mask = [1, 2, 7][i % 3]);
                    rays.iter_mut().step_by(5).for_each(|ray| *ray = ray.within(0.1, 0.7));
                    for tree in [&tree, &masked] {
                        let expected: Vec<_> = rays.iter().map(|ray| tree.closest(ray, &mut ())).collect();
                        hits += expected.iter().flatten().count();
                        for level in Level::available() {
                            for found in level.run(Alone(tree, &rays)).into_iter().flatten() {
                                assert_eq!(found, expected, "{count} rays, {spread}, {}", level.name());
                                tiles += 1;
                            }
                        }
                    }
                }
            }
        }
        assert!(hits > 2_000 && tiles > 1_000 * Level::available().len(), "{hits} hits of {tiles} tiles");
    }
}
