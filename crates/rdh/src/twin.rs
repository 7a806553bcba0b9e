//! A leaky twin of the eight-wide hierarchy, which exists to measure what watertightness costs: the same tree and the same walk, but
//! rays that may slip through edges. Only with the feature `twin`, for benchmarks.

use crate::accel::{Accel, Structure};
use crate::bvh::{Copies, Leaves, trace};
use crate::geom::{Hit, Ray, Scale};
use crate::mem::Array;
use crate::simd::{Block, Boxes, Entered, Job, Kernels, LANES, LeakyRay, Level};

/// A hierarchy whose answers may be wrong.
#[derive(Debug, Clone)]
pub struct Twin {
    nodes: Array<Boxes<8>>,
    /// Not three corners, but one and the edges that leave it.
    edges: Copies,
    level: Level,
}

impl Twin {
    /// That of a `bvh8` or `sbvh8` over a mesh that is not scaled. Nothing for other structures, and on CPUs without AVX2.
    pub fn of(accel: &Accel) -> Option<Self> {
        let Structure::Bvh8(tree) = accel.structure() else { return None };
        let level = Level::best();
        if level == Level::PORTABLE || Scale::of(&accel.mesh().bounds()).factor() != 1.0 {
            return None;
        }
        let edges: Vec<Block> = tree.blocks().iter().map(edges).collect();
        Some(Self { nodes: tree.nodes().clone(), edges: Copies::new(edges.into(), accel.mesh()), level })
    }

    /// The nearest hit, or nearly so.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.level.run(Cast::<false> { twin: self, ray })
    }

    /// Whether anything is hit, or nearly so.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.level.run(Cast::<true> { twin: self, ray }).is_some()
    }
}

fn edges(block: &Block) -> Block {
    let mut edges = *block;
    for lane in 0..LANES {
        let [a, b, c] = block.corners(lane);
        let from_a = |p: [f32; 3]| [0, 1, 2].map(|i| p[i] - a[i]);
        edges.set(lane, &[a, from_a(b), from_a(c)], block.ids[lane]);
    }
    edges
}

struct Cast<'a, const ANY: bool> {
    twin: &'a Twin,
    ray: &'a Ray,
}

impl<const ANY: bool> Job for Cast<'_, ANY> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Hit> {
        if K::MASKS { self.cast::<K, true>() } else { self.cast::<K, false>() }
    }
}

impl<const ANY: bool> Cast<'_, ANY> {
    #[inline(always)]
    fn cast<K: Kernels, const MASKS: bool>(self) -> Option<Hit> {
        let mut caster = Leaky::<ANY, MASKS>(LeakyRay::new(self.ray));
        trace::walk::<K, _, _, _, 8>(&self.twin.nodes, &self.twin.edges, &mut caster, &mut ());
        caster.0.hit
    }
}

struct Leaky<const ANY: bool, const MASKS: bool>(LeakyRay<MASKS>);

impl<const ANY: bool, const MASKS: bool> trace::Caster<8> for Leaky<ANY, MASKS> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn meet(&self, boxes: &Boxes<8>, t: &mut Entered<8>) -> u32 {
        self.0.meet(boxes, t)
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.0.end()
    }

    #[inline(always)]
    fn test(&mut self, block: &Block, wanted: u32) -> bool {
        self.0.test::<ANY>(block, wanted)
    }
}
