//! A tile's way through the tree: nearest boxes first, without recursion or allocation.

use crate::bvh::Bvh;
use crate::bvh::leaves::{AnyLeaves, Corners};
use crate::bvh::link::Link;
use crate::bvh::trace::STACK;
use crate::leaf::Collector;
use crate::mem::{Slots, Stack};
use crate::simd::{Entered, Floats, Kernels};
use crate::tile::{Bundle, Leaf, PACKETS, Planes};

/// A child to be visited: where the beam enters its box, and which packets may meet it.
#[derive(Debug, Clone, Copy)]
struct Entry {
    t: f32,
    node: u32,
    lane: u8,
    first: u8,
    last: u8,
}

impl<R: Floats> Bundle<R, Bvh<8, AnyLeaves>> {
    /// Leads the tile through the tree; not to the end if that becomes too dear.
    #[inline(always)]
    pub(super) fn walk<K: Kernels<Eight = R::Eight>, C: Collector>(&mut self, tree: &Bvh<8, AnyLeaves>) -> bool {
        let mut slots = Slots::<Entry, STACK>::new();
        let mut stack = slots.stack();
        let mut scratch = bytemuck::Zeroable::zeroed();
        let mut t = Entered([0.0; 8]);
        let root = Entry { t: f32::NEG_INFINITY, node: 0, lane: 0, first: 0, last: (self.tile.count - 1) as u8 };
        self.enter::<C>(tree, root, 0, &mut stack, &mut t);
        while let Some(entry) = stack.pop() {
            if entry.t > self.lead.end() {
                continue;
            }
            let boxes = &tree.nodes[entry.node as usize];
            let link = Link(boxes.links[usize::from(entry.lane) & 7]);
            let planes = Planes::new(boxes, usize::from(entry.lane), self.tile.class);
            if link.is_leaf() {
                let block = tree.leaves.corners::<K>(link.block(), &mut scratch);
                let leaf = Leaf { block, wanted: link.lanes(), masks: tree.masks.as_deref() };
                self.test::<C>(&leaf, &planes, entry);
            } else if let Some(entry) = self.narrow(&planes, entry) {
                self.effort.node(u32::from(entry.last - entry.first) + 1);
                if self.effort.is_hopeless() {
                    return false;
                }
                self.enter::<C>(tree, entry, link.index(), &mut stack, &mut t);
            }
        }
        true
    }

    /// The same for the packets from the first to the last that meet the box; nothing if there are none.
    #[inline(always)]
    fn narrow(&self, planes: &Planes<R>, mut entry: Entry) -> Option<Entry> {
        while self.tile.packets[usize::from(entry.first) & (PACKETS - 1)].meet(planes) == 0 {
            if entry.first == entry.last {
                return None;
            }
            entry.first += 1;
        }
        while entry.first < entry.last && self.tile.packets[usize::from(entry.last) & (PACKETS - 1)].meet(planes) == 0 {
            entry.last -= 1;
        }
        Some(entry)
    }

    /// Puts the children of a node on the stack that the beam meets: the nearest on top, or, where any hit will do, the first.
    #[inline(always)]
    fn enter<C: Collector>(
        &self,
        tree: &Bvh<8, AnyLeaves>,
        entry: Entry,
        node: usize,
        stack: &mut Stack<'_, Entry, STACK>,
        t: &mut Entered<8>,
    ) {
        let mut met = self.lead.meet(&tree.nodes[node], t);
        let bottom = stack.len();
        while met != 0 {
            let lane = if C::ANY { 7 - (met << 24).leading_zeros() } else { met.trailing_zeros() } & 7;
            met &= !(1 << lane);
            let child = Entry { t: t.0[lane as usize], node: node as u32, lane: lane as u8, ..entry };
            if C::ANY {
                stack.push(child);
            } else {
                stack.insert(bottom, child, |a, b| a.t < b.t);
            }
        }
    }

    /// Tests the rays that meet a leaf's box.
    #[inline(always)]
    fn test<C: Collector>(&mut self, leaf: &Leaf<'_>, planes: &Planes<R>, entry: Entry) {
        let mut moved = false;
        self.effort.boxes(u32::from(entry.last - entry.first) + 1);
        for packet in &mut self.tile.packets[usize::from(entry.first)..=usize::from(entry.last) & (PACKETS - 1)] {
            let rays = packet.meet(planes);
            if rays != 0 {
                self.effort.leaf(rays, leaf.wanted);
                moved |= if C::ANY {
                    packet.test::<true>(leaf, rays, self.tile.class)
                } else {
                    packet.test::<false>(leaf, rays, self.tile.class)
                };
            }
        }
        if moved {
            let mut ends = R::splat(f32::NEG_INFINITY);
            for packet in &self.tile.packets[..self.tile.count] {
                ends = ends.max(packet.end);
            }
            self.lead.end_at(ends);
        }
    }
}
