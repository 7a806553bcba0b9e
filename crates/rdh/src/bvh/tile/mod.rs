//! Coherent rays through the tree of eight, in tiles of 64.
//!
//! The `beam` around a tile's rays says which children of a node are met at all; a child's own box is tested against the packets when its
//! turn comes. So most nodes cost a tile little more than they cost a ray.

mod beam;
mod part;
mod sorted;
mod walk;

pub(crate) use part::Part;

use crate::bvh::Bvh;
use crate::bvh::leaves::AnyLeaves;
use crate::simd::{Floats, Kernels};
use crate::tile::{Bundle, Packed, Prices, Space, Tiled};

use beam::Beam;

/// What it costs: fitted to 9,344 groups of 16 tiles that were cast both ways, in twelve scenes, rows, shadows, AO and bounces, in units in
/// which `eye/effort.rs` reckons, too. 2 % of the groups for nearest hits are judged wrongly, and 4 % of those for any, which costs 0.6 and
/// 1.2 % of the time (Zen 3).
pub(crate) struct Costs;

impl Prices for Costs {
    const READY: u32 = 50;
    /// The beam against its children, their places on the stack, and two packets and more against each.
    const NODE: u32 = 340;
    const BOX: u32 = 105;
    const SIFT: u32 = 45;
    const RAY: u32 = 80;
    const PACKET_ALONE: u32 = 175;
    const TEST_ALONE: u32 = 96;
    const COUNTED_RAY: u64 = 100;
    const COUNTED_NODE: u64 = 25;
    const COUNTED_LEAF: u64 = 75;
}

impl Tiled for Bvh<8, AnyLeaves> {
    type Lead<R: Floats> = Beam<R::Eight>;
    type Costs = Costs;

    fn space(&self) -> Space {
        let Self { scale, bounds, magnitude, ref masks, .. } = *self;
        Space { scale, bounds, magnitude, has_masks: masks.is_some() }
    }

    #[inline(always)]
    fn walk<K: Kernels, C: Packed>(&self, bundle: &mut Bundle<K::Rays, Self>) -> bool {
        bundle.walk::<K, C>(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{BvhSpec, Copies};
    use crate::geom::{Hit, Ray};
    use crate::leaf::{Any, Closest};
    use crate::simd::{Job, Level, Two};
    use crate::tile::Choice;
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
            let (tree, choice) = (&self.0.with_any_leaves(), Choice::run(0, self.1.len()));
            let (mut bundle, space) = (Bundle::<R, _>::empty(), tree.space());
            if !bundle.fill(self.1, &choice, &space) {
                return None;
            }
            if !bundle.walk::<K, Closest>(tree) {
                return None;
            }
            let (mut hits, mut any) = (vec![None; self.1.len()], vec![false; self.1.len()]);
            bundle.tile.read::<Closest>(choice.rays(), &mut hits);
            assert!(bundle.fill(self.1, &choice, &space));
            assert!(bundle.walk::<K, Any>(tree), "it goes to the end where the nearest hits are found");
            bundle.tile.read::<Any>(choice.rays(), &mut any);
            assert!(
                any.iter().copied().eq(hits.iter().map(Option::is_some)),
                "any hit is found where the nearest one is"
            );
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
