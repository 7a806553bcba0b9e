//! Rays through the tree: front to back, without recursion or allocation.
//!
//! A ray is thickened by the slack of [`PlaneFrame`]: at every split plane the near child counts until `t + pad`, the far one
//! from `t − pad`. So each cell is visited whose box, grown by the slack, the ray meets, and no hit that THE triangle test
//! accepts lies elsewhere (the argument stands in `geom/triangle.rs`). What is visited ends where the best hit so far
//! is nearer than anything in the cell: a hit found in a cell may lie outside of it, and counts all the same.

use std::hint::select_unpredictable;

use super::KdTree;
use super::node::Node;
use super::stop::StopRule;
use crate::geom::{PlaneFrame, Ray, larger, smaller};
use crate::leaf::{Collector, Tester};
use crate::mem::Slots;
use crate::probe::Probe;
use crate::simd::{Job, Kernels};

/// One ray's way through a tree.
pub(crate) struct Walk<'a, P, C: Collector> {
    pub(crate) tree: &'a KdTree,
    pub(crate) ray: &'a Ray,
    pub(crate) probe: &'a mut P,
    pub(crate) start: C::Start,
}

/// A subtree to be visited, and the part of the ray that is in it.
#[derive(Clone, Copy)]
struct Entry {
    node: Node,
    t_near: f32,
    t_far: f32,
}

/// The value of an axis index that stands for a leaf; arrays have four elements so that no index needs a check.
const LEAF: usize = 3;

/// A ray's constants for split planes: t = split · inverse + start, less and more the pad.
struct Planes {
    inverse: [f32; 4],
    enters: [f32; 4],
    leaves: [f32; 4],
    /// A bit an axis: 1 where the ray runs down the axis and meets the right child first.
    down: u32,
}

impl Planes {
    #[inline(always)]
    fn new(frame: &PlaneFrame) -> Self {
        let ([x, y, z], [ox, oy, oz], [px, py, pz]) = (frame.inverse, frame.origin, frame.pad);
        let (sx, sy, sz) = (-ox * x, -oy * y, -oz * z);
        Self {
            inverse: [x, y, z, 0.0],
            enters: [sx - px, sy - py, sz - pz, 0.0],
            leaves: [sx + px, sy + py, sz + pz, 0.0],
            down: x.to_bits() >> 31 | y.to_bits() >> 31 << 1 | z.to_bits() >> 31 << 2,
        }
    }
}

impl<P: Probe, C: Collector> Job for Walk<'_, P, C> {
    /// What was collected.
    type Output = C::Output;

    #[inline(always)]
    fn run<K: Kernels>(self) -> C::Output {
        let mut collector = C::new(self.start);
        if !self.ray.is_valid() {
            return collector.finish();
        }
        let tree = self.tree;
        let plane_frame = PlaneFrame::new(self.ray, tree.scale, tree.magnitude);
        let (mut t_near, mut t_far) = plane_frame.span(&tree.bounds);
        if t_near > t_far {
            return collector.finish();
        }
        let mut tester = Tester::<K>::new(self.ray, tree.masks.as_deref());
        let planes = Planes::new(&plane_frame);
        let mut slots = Slots::<Entry, { StopRule::DEEPEST as usize + 1 }>::new();
        let mut stack = slots.stack();
        let pairs = tree.pairs();
        let mut node = tree.root;
        // The end of interest in the tree's own `t`.
        let mut end = f32::INFINITY;
        loop {
            let a = node.axis_index();
            if a != LEAF {
                self.probe.interior();
                let along = node.split() * planes.inverse[a];
                let (far_from, near_until) = (along + planes.enters[a], along + planes.leaves[a]);
                // Both children are fetched before the side is known: the way from node to node is what takes the time.
                let [left, right] = pairs[node.pair() as usize];
                let down = planes.down & (1 << a) != 0;
                let near = select_unpredictable(down, right, left);
                let far = select_unpredictable(down, left, right);
                if far_from > t_far {
                    node = near;
                } else if near_until < t_near {
                    node = far;
                } else {
                    stack.push(Entry { node: far, t_near: larger(far_from, t_near), t_far });
                    node = near;
                    t_far = smaller(near_until, t_far);
                }
                continue;
            }
            let (block, lane, count) = node.triangles();
            self.probe.leaf(count);
            if count > 0 {
                let blocks = &tree.blocks[block as usize..];
                match tester.test_run(blocks, lane, count, &mut collector) {
                    Some(true) => end = plane_frame.scaled_t(tester.t_max()).next_up(),
                    Some(false) => {}
                    None => return collector.finish(),
                }
            }
            let entry = loop {
                match stack.pop() {
                    None => return collector.finish(),
                    Some(entry) if entry.t_near > end => {}
                    Some(entry) => break entry,
                }
            };
            node = entry.node;
            t_near = entry.t_near;
            t_far = smaller(entry.t_far, end);
        }
    }
}
