//! Rays through the tree: front to back, without recursion or allocation.
//!
//! A ray is thickened by the slack of [`PlaneFrame`]: at every split plane the near child counts until `t + pad`, the far one
//! from `t − pad`. So each cell is visited whose box, grown by the slack, the ray meets, and no hit that THE triangle test
//! accepts lies elsewhere (the argument stands in `geom/triangle.rs`). What is visited ends where the best hit so far
//! is nearer than anything in the cell: a hit found in a cell may lie outside of it, and counts all the same.
//!
//! The way from node to node would be a chain: fetch the children, find the near one, fetch its children. So nothing in it waits for
//! data where a branch can be guessed: which child is near, and whether its children are the next pair, as they are for the likelier one
//! (`layout.rs`).

use super::KdTree;
use super::node::Node;
use super::stop::StopRule;
use crate::geom::{PlaneFrame, Ray, larger, smaller};
use crate::leaf::{Collector, Tester};
use crate::mem::{Slots, Stack};
use crate::probe::Probe;
use crate::simd::{Job, Kernels, apart, guessed_next};

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

/// The most subtrees that wait: one on each level.
pub(super) const STACK: usize = StopRule::DEEPEST as usize + 1;

/// The part of the ray that is in the node at hand, and what waits behind it.
struct Way<'s> {
    t_near: f32,
    t_far: f32,
    stack: Stack<'s, Entry, STACK>,
}

impl Way<'_> {
    /// The child to go on with, where the far one counts from a `t` on, and the near one until another.
    #[inline(always)]
    fn take<const WAY: u32>(&mut self, near: Node, far: Node, (far_from, near_until): (f32, f32)) -> Node {
        apart::<WAY>();
        if far_from > self.t_far {
            return near;
        }
        if near_until < self.t_near {
            return far;
        }
        self.stack.push(Entry { node: far, t_near: larger(far_from, self.t_near), t_far: self.t_far });
        self.t_far = smaller(near_until, self.t_far);
        apart::<WAY>();
        near
    }

    /// The subtree that is next, if any begins before the end of interest.
    #[inline(always)]
    fn next(&mut self, end: f32) -> Option<Node> {
        loop {
            let entry = self.stack.pop()?;
            let is_beyond = entry.t_near > end;
            if !is_beyond {
                (self.t_near, self.t_far) = (entry.t_near, smaller(entry.t_far, end));
                return Some(entry.node);
            }
        }
    }
}

/// The value of an axis index that stands for a leaf; arrays have four elements so that no index needs a check.
pub(super) const LEAF: usize = 3;

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
        let (t_near, t_far) = plane_frame.span(&tree.bounds);
        if t_near > t_far {
            return collector.finish();
        }
        let mut tester = Tester::<K>::new(self.ray, tree.masks.as_deref());
        let planes = Planes::new(&plane_frame);
        let mut slots = Slots::new();
        let mut way = Way { t_near, t_far, stack: slots.stack() };
        let pairs = tree.pairs();
        let mut node = tree.root;
        // The pair that was fetched last. The root's children are the first one.
        let mut pair = u32::MAX;
        // The end of interest in the tree's own `t`.
        let mut end = f32::INFINITY;
        loop {
            let a = node.axis_index();
            if a != LEAF {
                self.probe.interior();
                let along = node.split() * planes.inverse[a];
                let span = (along + planes.enters[a], along + planes.leaves[a]);
                pair = guessed_next(pair, node.pair());
                let [left, right] = pairs[pair as usize];
                node = if planes.down & (1 << a) != 0 {
                    way.take::<1>(right, left, span)
                } else {
                    way.take::<0>(left, right, span)
                };
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
            node = match way.next(end) {
                Some(next) => next,
                None => return collector.finish(),
            };
        }
    }
}
