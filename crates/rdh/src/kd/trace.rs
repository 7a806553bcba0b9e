//! Rays through the tree: front to back, without recursion or allocation.
//!
//! A ray is thickened by the slack of [`PlaneFrame`]: at every split plane the near child counts until `t + pad`, the far one
//! from `t − pad`. So each cell is visited whose box, grown by the slack, the ray meets, and no hit that THE triangle test
//! accepts lies elsewhere (the argument stands in `geom/triangle.rs`). What is visited ends where the best hit so far
//! is nearer than anything in the cell: a hit found in a cell may lie outside of it, and counts all the same.

use super::KdTree;
use super::node::NodeKind;
use crate::geom::{Hit, PlaneFrame, Ray, RayFrame, TriId, hit_triangle, owns_crossing};
use crate::mem::Stack;
use crate::probe::Probe;
use crate::simd::{Block, Job, Kernels, LANES};

use super::stop::StopRule;

/// What becomes of hits.
pub(crate) trait Collector {
    /// Takes a hit; returns the largest `t` that is still of interest, or nothing if the ray is done.
    fn take(&mut self, hit: Hit, frame: &RayFrame, corners: impl FnOnce() -> [[f32; 3]; 3]) -> Option<f32>;
}

/// The nearest hit.
#[derive(Default)]
pub(crate) struct Closest(pub(crate) Option<Hit>);

impl Collector for Closest {
    #[inline(always)]
    fn take(&mut self, hit: Hit, frame: &RayFrame, _corners: impl FnOnce() -> [[f32; 3]; 3]) -> Option<f32> {
        if self.0.is_none_or(|best| hit.wins_over(&best)) {
            self.0 = Some(hit);
        }
        Some(self.0.map_or(frame.t_max, |best| best.t))
    }
}

/// Whether there is any hit.
#[derive(Default)]
pub(crate) struct Any(pub(crate) bool);

impl Collector for Any {
    #[inline(always)]
    fn take(&mut self, _hit: Hit, _frame: &RayFrame, _corners: impl FnOnce() -> [[f32; 3]; 3]) -> Option<f32> {
        self.0 = true;
        None
    }
}

/// All hits that own their crossing; one that lies in several cells comes several times.
pub(crate) struct All<'a>(pub(crate) &'a mut Vec<Hit>);

impl Collector for All<'_> {
    #[inline(always)]
    fn take(&mut self, hit: Hit, frame: &RayFrame, corners: impl FnOnce() -> [[f32; 3]; 3]) -> Option<f32> {
        if owns_crossing(frame, &corners()) {
            self.0.push(hit);
        }
        Some(frame.t_max)
    }
}

/// One ray's way through a tree.
pub(crate) struct Walk<'a, P, C> {
    pub(crate) tree: &'a KdTree,
    pub(crate) ray: &'a Ray,
    pub(crate) probe: &'a mut P,
    pub(crate) collector: &'a mut C,
}

/// A subtree to be visited, and the part of the ray that is in it.
#[derive(Clone, Copy)]
struct Entry {
    node: u32,
    t_near: f32,
    t_far: f32,
}

/// The root's index; it does not lie with the pairs.
const ROOT: u32 = u32::MAX;

impl<P: Probe, C: Collector> Job for Walk<'_, P, C> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        if !self.ray.is_valid() {
            return;
        }
        let tree = self.tree;
        let planes = PlaneFrame::new(self.ray, tree.scale, &tree.bounds, tree.magnitude);
        let mut frame = RayFrame::new(self.ray);
        let lanes = K::frame(&frame);
        // t = split · inverse − origin · inverse, minus and plus the pad.
        let (mut enters, mut leaves, mut near_side) = ([0.0; 3], [0.0; 3], [0; 3]);
        for a in 0..3 {
            let start = -planes.origin[a] * planes.inverse[a];
            enters[a] = start - planes.pad[a];
            leaves[a] = start + planes.pad[a];
            near_side[a] = planes.inverse[a].to_bits() >> 31;
        }
        let mut stack = Stack::<Entry, { StopRule::DEEPEST as usize + 1 }>::new();
        let mut now = Entry { node: ROOT, t_near: planes.t_near, t_far: planes.t_far };
        if now.t_near > now.t_far {
            return;
        }
        let nodes = tree.nodes();
        // The end of interest in the tree's own `t`.
        let mut end = f32::INFINITY;
        loop {
            let node = if now.node == ROOT { tree.root } else { nodes[now.node as usize] };
            match node.kind() {
                NodeKind::Interior { axis, split, pair } => {
                    self.probe.interior();
                    let a = axis.index();
                    let along = split * planes.inverse[a];
                    let (far_from, near_until) = (along + enters[a], along + leaves[a]);
                    let near = 2 * pair + near_side[a];
                    if far_from > now.t_far {
                        now.node = near;
                    } else if near_until < now.t_near {
                        now.node = near ^ 1;
                    } else {
                        let t_near = if far_from > now.t_near { far_from } else { now.t_near };
                        stack.push(Entry { node: near ^ 1, t_near, t_far: now.t_far });
                        now.node = near;
                        now.t_far = if near_until < now.t_far { near_until } else { now.t_far };
                    }
                    continue;
                }
                NodeKind::Leaf { block, lane, count } => {
                    self.probe.leaf(count);
                    if count > 0 {
                        let blocks = &tree.blocks[block as usize..];
                        match visit::<K, C>(tree, self.ray, &mut frame, &lanes, blocks, (lane, count), self.collector) {
                            Some(true) => end = planes.scaled_t(frame.t_max).next_up(),
                            Some(false) => {}
                            None => return,
                        }
                    }
                }
            }
            loop {
                match stack.pop() {
                    None => return,
                    Some(entry) if entry.t_near > end => {}
                    Some(entry) => {
                        now = entry;
                        break;
                    }
                }
            }
            now.t_far = if now.t_far < end { now.t_far } else { end };
        }
    }
}

/// Tests a leaf's triangles: whether the end of interest has moved; nothing if the ray is done.
#[inline(always)]
fn visit<K: Kernels, C: Collector>(
    tree: &KdTree,
    ray: &Ray,
    frame: &mut RayFrame,
    lanes: &K::Frame,
    blocks: &[Block],
    (lane, count): (u32, u32),
    collector: &mut C,
) -> Option<bool> {
    let mut moved = false;
    let mut left = count;
    let mut lane = lane;
    for block in blocks {
        let here = left.min(LANES as u32 - lane);
        let wanted = ((1u32 << here) - 1) << lane;
        let mut candidates = K::candidates(lanes, block) & wanted;
        while candidates != 0 {
            let i = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            let id = block.ids[i];
            let Some(hit) = hit_triangle(frame, &block.corners(i), TriId(id)) else { continue };
            if tree.masks.as_ref().is_some_and(|m| m[id as usize] & ray.mask == 0) {
                continue;
            }
            let t_max = collector.take(hit, frame, || block.corners(i))?;
            moved |= t_max < frame.t_max;
            frame.t_max = t_max;
        }
        left -= here;
        lane = 0;
        if left == 0 {
            break;
        }
    }
    Some(moved)
}
