//! Rays through what has grown; what they reach grows.

use super::Tree;
use super::ground::Ground;
use super::part::DEEPEST;
use super::runs;
use super::subtree::{Grown, Subtree};
use crate::bvh::Extent;
use crate::bvh::trace::{Caster, Watertight};
use crate::geom::Ray;
use crate::leaf::{Collector, Tester};
use crate::mem::Slots;
use crate::mesh::Mesh;
use crate::probe::Probe;
use crate::simd::{Block, Entered, Job, Kernels, LANES};

/// One ray's way.
pub(super) struct Walk<'a, P, C: Collector> {
    pub(super) tree: &'a Tree,
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a mut P,
    pub(super) start: C::Start,
}

impl<P: Probe, C: Collector> Job for Walk<'_, P, C> {
    /// What was collected.
    type Output = C::Output;

    #[inline(always)]
    fn run<K: Kernels>(self) -> C::Output {
        let Self { tree, ray, probe, start } = self;
        let collector = C::new(start);
        let space = &tree.ground.space;
        let Some(boxes) = K::box_ray(ray, space.scale, space.magnitude) else { return collector.finish() };
        let tester = Tester::<K>::new(ray, tree.ground.mesh.masks());
        let mut caster = Watertight { boxes, tester, collector };
        walk::<K, _, _>(&tree.ground, &tree.root, &mut caster, probe);
        caster.collector.finish()
    }
}

/// A subtree to be visited, and where the ray enters its box.
#[derive(Clone, Copy)]
struct Entry<'a> {
    t: f32,
    subtree: &'a Subtree,
}

/// The most entries that wait: all children but one of each node on the way down, and what was popped last.
const STACK: usize = 7 * DEEPEST as usize + 8;

#[inline(always)]
fn walk<K: Kernels, T: Caster<8>, P: Probe>(ground: &Ground, root: &Subtree, caster: &mut T, probe: &mut P) {
    let mut slots = Slots::<Entry<'_>, STACK>::new();
    let mut stack = slots.stack();
    let mut t = Entered([0.0; 8]);
    let mut subtree = root;
    loop {
        match subtree.get(ground) {
            Grown::Node(node) => {
                probe.interior();
                let mut met = caster.meet(&node.boxes, &mut t);
                let bottom = stack.len();
                while met != 0 {
                    // Any hit will do: the largest box lies on top, else the nearest.
                    let lane = if T::ANY { 31 - met.leading_zeros() } else { met.trailing_zeros() } as usize & 7;
                    met &= !(1 << lane);
                    let entry = Entry { t: t.0[lane], subtree: &node.children[lane] };
                    if T::ANY { stack.push(entry) } else { stack.insert(bottom, entry, |a, b| a.t < b.t) }
                }
            }
            Grown::Tree(tree) => {
                if !tree.lead::<K, _, _>(caster, probe) {
                    return;
                }
            }
            Grown::Bare(runs) => {
                if !test_all(&ground.mesh, runs, caster, probe) {
                    return;
                }
            }
        }
        subtree = loop {
            match stack.pop() {
                None => return,
                Some(entry) if !T::ANY && entry.t > caster.end() => {}
                Some(entry) => break entry.subtree,
            }
        };
    }
}

/// Tests the triangles of runs, eight at a time; whether the ray goes on.
#[inline(always)]
fn test_all<T: Caster<8>, P: Probe>(mesh: &Mesh, runs: &[Extent], caster: &mut T, probe: &mut P) -> bool {
    let mut triangles = runs.iter().flat_map(|run| runs::triangles(mesh, *run));
    let mut block: Block = bytemuck::Zeroable::zeroed();
    loop {
        let mut n = 0;
        for tri in triangles.by_ref().take(LANES) {
            block.set(n, &mesh.corners(tri), tri.0);
            n += 1;
        }
        if n == 0 {
            return true;
        }
        probe.leaf(n as u32);
        if !caster.test(&block, (1 << n) - 1) {
            return false;
        }
    }
}
