//! A tile's way through the tree: front to back, without recursion or allocation.
//!
//! At every split plane the near child counts for a packet until its last ray may have crossed the plane, the far one from where its
//! first ray may cross it: what single rays do (`kd/trace.rs`), with intervals that hold for all of them. So a packet comes to each leaf
//! that one of its rays would come to; there each ray's own interval decides.

use crate::geom::Aabb;
use crate::kd::KdTree;
use crate::kd::node::Node;
use crate::kd::trace::{LEAF, STACK};
use crate::leaf::Collector;
use crate::mem::Slots;
use crate::simd::{Floats, LANES, highest};
use crate::tile::{Bundle, Class, Leaf, PACKETS, Packet, Planes};

/// The box of a node, by which of its planes rays of a class meet first.
#[derive(Debug, Clone, Copy)]
struct Cell {
    near: [f32; 3],
    far: [f32; 3],
}

impl Cell {
    #[inline(always)]
    fn of(bounds: &Aabb, class: Class) -> Self {
        let mut cell = Self { near: bounds.min, far: bounds.max };
        for a in 0..3 {
            if class.near(a) == 1 {
                (cell.near[a], cell.far[a]) = (cell.far[a], cell.near[a]);
            }
        }
        cell
    }

    /// The part in front of a split plane.
    #[inline(always)]
    fn in_front(mut self, axis: usize, split: f32) -> Self {
        self.far[axis] = split;
        self
    }

    /// The part behind it.
    #[inline(always)]
    fn behind(mut self, axis: usize, split: f32) -> Self {
        self.near[axis] = split;
        self
    }
}

/// A subtree to be visited: its cell, the packets that may meet it, a bit each, and between which `t`.
#[derive(Debug, Clone, Copy)]
struct Entry<E> {
    from: E,
    until: E,
    cell: Cell,
    node: Node,
    packets: u32,
}

impl<R: Floats> Bundle<R, KdTree> {
    /// Leads the tile through the tree; not to the end if that becomes too dear.
    #[inline(always)]
    pub(super) fn walk<C: Collector>(&mut self, tree: &KdTree) -> bool {
        let mut slots = Slots::<Entry<R::Eight>, STACK>::new();
        let (mut stack, pairs, class) = (slots.stack(), tree.pairs(), self.tile.class);
        let mut at = self.set_out(tree);
        loop {
            let a = at.node.axis_index();
            if at.packets != 0 && a != LEAF {
                self.effort.node(at.packets.count_ones());
                let split = at.node.split();
                let (from, until) = self.lead.meet(a, split);
                let [left, right] = pairs[at.node.pair() as usize];
                let (near, far) = if class.near(a) == 1 { (right, left) } else { (left, right) };
                let to_near = at.packets & !until.lt(at.from).signs();
                let to_far = at.packets & !at.until.lt(from).signs();
                if to_far == 0 {
                    at = Entry { node: near, cell: at.cell.in_front(a, split), packets: to_near, ..at };
                } else if to_near == 0 {
                    at = Entry { node: far, cell: at.cell.behind(a, split), packets: to_far, ..at };
                } else {
                    let (from, cell) = (from.max(at.from), at.cell.behind(a, split));
                    stack.push(Entry { node: far, from, until: at.until, cell, packets: to_far });
                    let (until, cell) = (until.min(at.until), at.cell.in_front(a, split));
                    at = Entry { node: near, from: at.from, until, cell, packets: to_near };
                }
                continue;
            }
            if at.packets != 0 {
                self.test::<C>(tree, &at);
            }
            if self.effort.is_hopeless() {
                return false;
            }
            let Some(next) = stack.pop() else { return true };
            let packets = next.packets & next.from.le(self.lead.end).signs();
            at = Entry { until: next.until.min(self.lead.end), packets, ..next };
        }
    }

    /// At the root, with the packets that may meet the tree's box.
    #[inline(always)]
    fn set_out(&self, tree: &KdTree) -> Entry<R::Eight> {
        let cell = Cell::of(&tree.bounds, self.tile.class);
        let (mut from, mut until) = (self.lead.start, self.lead.end);
        for a in 0..3 {
            from = from.max(self.lead.meet(a, cell.near[a]).0);
            until = until.min(self.lead.meet(a, cell.far[a]).1);
        }
        let packets = from.le(until).signs() & ((1 << self.tile.count) - 1);
        Entry { from, until, cell, node: tree.root, packets }
    }

    /// Tests the rays that meet a leaf's cell.
    #[inline(always)]
    fn test<C: Collector>(&mut self, tree: &KdTree, at: &Entry<R::Eight>) {
        let (block, lane, count) = at.node.triangles();
        if count == 0 {
            return;
        }
        let (planes, mut packets) = (Planes::of(&at.cell.near, &at.cell.far), at.packets);
        self.effort.boxes(packets.count_ones());
        while packets != 0 {
            let i = packets.trailing_zeros() as usize & (PACKETS - 1);
            packets &= packets - 1;
            let rays = self.tile.packets[i].meet(&planes);
            if rays != 0 && self.test_run::<C>(tree, (block, lane, count), i, rays) {
                self.lead.end.set_lane(i, highest(&self.tile.packets[i].end));
            }
        }
    }

    /// Tests some rays of a packet against triangles that begin in a lane of a block: whether one ends earlier.
    #[inline(always)]
    fn test_run<C: Collector>(
        &mut self,
        tree: &KdTree,
        (block, mut lane, mut left): (u32, u32, u32),
        packet: usize,
        rays: u32,
    ) -> bool {
        let (packet, class, mut moved): (&mut Packet<R>, _, _) =
            (&mut self.tile.packets[packet], self.tile.class, false);
        for block in &tree.blocks[block as usize..] {
            let here = left.min(LANES as u32 - lane);
            let leaf = Leaf { block, wanted: ((1u32 << here) - 1) << lane, masks: tree.masks.as_deref() };
            self.effort.leaf(rays, leaf.wanted);
            moved |=
                if C::ANY { packet.test::<true>(&leaf, rays, class) } else { packet.test::<false>(&leaf, rays, class) };
            (left, lane) = (left - here, 0);
            if left == 0 {
                break;
            }
        }
        moved
    }
}
