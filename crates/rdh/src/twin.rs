//! A leaky twin of the eight-wide hierarchy, which exists to measure what watertightness costs: the same tree and the same walk, but
//! rays that may slip through edges. Only with the feature `twin`, for benchmarks.

use crate::accel::{Accel, Structure};
use crate::bvh::trace::{self, Caster};
use crate::bvh::{Bvh, Copies, Leaves};
use crate::geom::{Hit, Ray, Scale};
use crate::leaf::{self, Collector, Tester};
use crate::mem::Array;
use crate::simd::{Block, Boxes, Entered, Job, Kernels, LANES, LeakyRay, Level};

/// What lets rays slip through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leak {
    /// Box planes without slack.
    Boxes,
    /// Triangles by Möller and Trumbore in f32.
    Triangles,
    /// Both.
    Both,
}

/// A hierarchy whose answers may be wrong.
#[derive(Debug, Clone)]
pub struct Twin {
    original: Bvh<8>,
    /// Not three corners, but one and the edges that leave it.
    edges: Copies,
    masks: Option<Array<u32>>,
    leak: Leak,
    level: Level,
}

impl Twin {
    /// That of a `bvh8` or `sbvh8` over a mesh that is not scaled. Nothing for other structures, and on CPUs without AVX2.
    pub fn of(accel: &Accel, leak: Leak) -> Option<Self> {
        let Structure::Bvh8(tree) = accel.structure() else { return None };
        let level = Level::best();
        if level == Level::PORTABLE || Scale::of(&accel.mesh().bounds()).factor() != 1.0 {
            return None;
        }
        let edges: Vec<Block> = tree.leaves().blocks().iter().map(edges).collect();
        Some(Self {
            original: tree.clone(),
            edges: Copies::new(edges.into(), accel.mesh()),
            masks: accel.mesh().mask_array(),
            leak,
            level,
        })
    }

    /// The nearest hit, or nearly so.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        match self.leak {
            Leak::Boxes => self.level.run(InBoxes::<leaf::Closest> { twin: self, ray, start: () }),
            Leak::Triangles => self.level.run(InTriangles::<false> { twin: self, ray }),
            Leak::Both => self.level.run(InBoth::<false> { twin: self, ray }),
        }
    }

    /// Whether anything is hit, or nearly so.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        match self.leak {
            Leak::Boxes => self.level.run(InBoxes::<leaf::Any> { twin: self, ray, start: () }),
            Leak::Triangles => self.level.run(InTriangles::<true> { twin: self, ray }).is_some(),
            Leak::Both => self.level.run(InBoth::<true> { twin: self, ray }).is_some(),
        }
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

struct InBoxes<'a, C: Collector> {
    twin: &'a Twin,
    ray: &'a Ray,
    start: C::Start,
}

impl<C: Collector> Job for InBoxes<'_, C> {
    type Output = C::Output;

    #[inline(always)]
    fn run<K: Kernels>(self) -> C::Output {
        if K::MASKS { self.cast::<K, true>() } else { self.cast::<K, false>() }
    }
}

impl<C: Collector> InBoxes<'_, C> {
    #[inline(always)]
    fn cast<K: Kernels, const MASKS: bool>(self) -> C::Output {
        let Self { twin, ray, start } = self;
        let masks = twin.masks.as_deref();
        let tester = Tester::<K>::new(ray, masks);
        let mut caster = LeakyBoxes { ray: LeakyRay::<MASKS>::new(ray, masks), tester, collector: C::new(start) };
        trace::walk::<K, _, _, _, 8>(twin.original.nodes(), twin.original.leaves(), &mut caster, &mut ());
        caster.collector.finish()
    }
}

struct LeakyBoxes<'a, K: Kernels, C, const MASKS: bool> {
    ray: LeakyRay<'a, MASKS>,
    tester: Tester<'a, K>,
    collector: C,
}

impl<K: Kernels, C: Collector, const MASKS: bool> Caster<8> for LeakyBoxes<'_, K, C, MASKS> {
    const ANY: bool = C::ANY;

    #[inline(always)]
    fn meet(&self, boxes: &Boxes<8>, t: &mut Entered<8>) -> u32 {
        self.ray.meet(boxes, t)
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.ray.end()
    }

    #[inline(always)]
    fn test(&mut self, block: &Block, wanted: u32) -> bool {
        match self.tester.test(block, wanted, &mut self.collector) {
            Some(true) => self.ray.end_at(self.tester.t_max()),
            Some(false) => {}
            None => return false,
        }
        true
    }
}

struct InTriangles<'a, const ANY: bool> {
    twin: &'a Twin,
    ray: &'a Ray,
}

impl<const ANY: bool> Job for InTriangles<'_, ANY> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Hit> {
        if K::MASKS { self.cast::<K, true>() } else { self.cast::<K, false>() }
    }
}

impl<const ANY: bool> InTriangles<'_, ANY> {
    #[inline(always)]
    fn cast<K: Kernels, const MASKS: bool>(self) -> Option<Hit> {
        let boxes = self.twin.original.box_ray::<K>(self.ray)?;
        let mut caster =
            LeakyTriangles::<K, ANY, MASKS> { boxes, ray: LeakyRay::new(self.ray, self.twin.masks.as_deref()) };
        trace::walk::<K, _, _, _, 8>(self.twin.original.nodes(), &self.twin.edges, &mut caster, &mut ());
        caster.ray.hit
    }
}

struct LeakyTriangles<'a, K: Kernels, const ANY: bool, const MASKS: bool> {
    boxes: K::BoxRay,
    ray: LeakyRay<'a, MASKS>,
}

impl<K: Kernels, const ANY: bool, const MASKS: bool> Caster<8> for LeakyTriangles<'_, K, ANY, MASKS> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn meet(&self, boxes: &Boxes<8>, t: &mut Entered<8>) -> u32 {
        K::meet(&self.boxes, boxes, t)
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        K::end(&self.boxes)
    }

    #[inline(always)]
    fn test(&mut self, block: &Block, wanted: u32) -> bool {
        let before = self.ray.end();
        let goes_on = self.ray.test::<ANY>(block, wanted);
        if self.ray.end() < before {
            K::end_at(&mut self.boxes, self.ray.end());
        }
        goes_on
    }
}

struct InBoth<'a, const ANY: bool> {
    twin: &'a Twin,
    ray: &'a Ray,
}

impl<const ANY: bool> Job for InBoth<'_, ANY> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Hit> {
        if K::MASKS { self.cast::<K, true>() } else { self.cast::<K, false>() }
    }
}

impl<const ANY: bool> InBoth<'_, ANY> {
    #[inline(always)]
    fn cast<K: Kernels, const MASKS: bool>(self) -> Option<Hit> {
        let mut caster = Leaky::<ANY, MASKS>(LeakyRay::new(self.ray, self.twin.masks.as_deref()));
        trace::walk::<K, _, _, _, 8>(self.twin.original.nodes(), &self.twin.edges, &mut caster, &mut ());
        caster.0.hit
    }
}

struct Leaky<'a, const ANY: bool, const MASKS: bool>(LeakyRay<'a, MASKS>);

impl<const ANY: bool, const MASKS: bool> Caster<8> for Leaky<'_, ANY, MASKS> {
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
