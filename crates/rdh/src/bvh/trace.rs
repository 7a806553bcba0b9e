//! Rays through the tree: nearest boxes first, without recursion or allocation.
//!
//! A box counts as wide as the slack of [`PlaneFrame`](crate::geom::PlaneFrame) on every side: each triangle that THE triangle test
//! would accept lies in boxes that the ray, so thickened, meets on the whole way from the root, not after the hit
//! (docs/watertight.md). Which boxes are met beyond that may differ between instruction sets; hits may not.

use super::Bvh;
use super::binary::DEEPEST;
use super::leaves::Corners;
use super::link::Link;
use crate::geom::Ray;
use crate::leaf::{Collector, Tester};
use crate::mem::{Slots, Stack};
use crate::probe::Probe;
use crate::simd::{Block, Boxes, Entered, Job, Kernels, guessed_if};

/// One ray's way through a tree.
pub(crate) struct Walk<'a, P, C: Collector, L, const W: usize> {
    pub(crate) tree: &'a Bvh<W, L>,
    pub(crate) ray: &'a Ray,
    pub(crate) probe: &'a mut P,
    pub(crate) start: C::Start,
}

impl<P: Probe, C: Collector, L: Corners, const W: usize> Job for Walk<'_, P, C, L, W> {
    /// What was collected.
    type Output = C::Output;

    #[inline(always)]
    fn run<K: Kernels>(self) -> C::Output {
        let Self { tree, ray, probe, start } = self;
        match Watertight::<K, C>::new(tree, ray, start) {
            Ok(mut caster) => {
                walk::<K, _, _, _, W>(&tree.nodes, &tree.leaves, &mut caster, probe);
                caster.finish()
            }
            Err(nothing) => nothing,
        }
    }
}

/// A ray that is being cast: what the walk asks of it.
pub(crate) trait Caster<const W: usize> {
    /// Whether the likeliest children come first, or the nearest.
    const ANY: bool;

    /// Which boxes it meets, a bit a lane, and where it enters them.
    fn meet(&self, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32;

    /// Where it ends, in the boxes' `t`.
    fn end(&self) -> f32;

    /// Tests the `wanted` triangles of a block; whether the ray goes on.
    fn test(&mut self, block: &Block, wanted: u32) -> bool;
}

/// Whose hits are those of THE triangle test.
pub(crate) struct Watertight<'a, K: Kernels, C> {
    pub(crate) boxes: K::BoxRay,
    pub(crate) tester: Tester<'a, K>,
    pub(crate) collector: C,
}

impl<'a, K: Kernels, C: Collector> Watertight<'a, K, C> {
    /// A ray made ready for a tree; what an invalid one collects is nothing.
    #[inline(always)]
    pub(super) fn new<L: Corners, const W: usize>(
        tree: &'a Bvh<W, L>,
        ray: &Ray,
        start: C::Start,
    ) -> Result<Self, C::Output> {
        let collector = C::new(start);
        let Some(boxes) = K::box_ray(ray, tree.scale, tree.magnitude) else { return Err(collector.finish()) };
        Ok(Self { boxes, tester: Tester::new(ray, tree.masks.as_deref()), collector })
    }

    /// What was collected.
    #[inline(always)]
    pub(super) fn finish(self) -> C::Output {
        self.collector.finish()
    }
}

impl<K: Kernels, C: Collector, const W: usize> Caster<W> for Watertight<'_, K, C> {
    const ANY: bool = C::ANY;

    #[inline(always)]
    fn meet(&self, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32 {
        K::meet(&self.boxes, boxes, t)
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        K::end(&self.boxes)
    }

    #[inline(always)]
    fn test(&mut self, block: &Block, wanted: u32) -> bool {
        match self.tester.test(block, wanted, &mut self.collector) {
            Some(true) => K::end_at(&mut self.boxes, self.tester.t_max()),
            Some(false) => {}
            None => return false,
        }
        true
    }
}

/// A child to be visited, and where the ray enters its box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) t: f32,
    pub(super) link: Link,
}

/// The most entries that wait: all children but one of each node on the way down, and what was popped last.
pub(super) const STACK: usize = 7 * DEEPEST as usize + 8;

/// Leads a ray through a tree, until it is done or there is nothing more: whether it goes on elsewhere.
#[inline(always)]
pub(crate) fn walk<K: Kernels, L: Corners, T: Caster<W>, P: Probe, const W: usize>(
    nodes: &[Boxes<W>],
    leaves: &L,
    caster: &mut T,
    probe: &mut P,
) -> bool {
    let mut slots = Slots::<Entry, STACK>::new();
    let mut stack = slots.stack();
    let mut scratch = bytemuck::Zeroable::zeroed();
    let mut link = Link::node(0);
    let mut t = Entered([0.0; W]);
    loop {
        if !link.is_leaf() {
            probe.interior();
            let node = &nodes[link.index()];
            let met = guessed_if::<W>(caster.meet(node, &mut t), !P::COUNTS);
            if met != 0 {
                let first = met.trailing_zeros() as usize & (W - 1);
                let rest = met & (met - 1);
                link = Link(node.links[first]);
                if rest == 0 {
                    continue;
                }
                if T::ANY {
                    link = push_all(&mut stack, &node.links, &t, link, rest);
                } else {
                    link = push_in_order(&mut stack, &node.links, &t, Entry { t: t.0[first], link }, rest);
                }
                continue;
            }
        } else {
            probe.leaf(link.count());
            if !caster.test(leaves.corners::<K>(link.block(), &mut scratch), link.lanes()) {
                return false;
            }
        }
        link = loop {
            match stack.pop() {
                None => return true,
                Some(entry) if !T::ANY && entry.t > caster.end() => {}
                Some(entry) => break entry.link,
            }
        };
    }
}

/// Any hit will do: the likeliest child comes first, in the order of the lanes.
#[inline(always)]
pub(super) fn push_all<const W: usize>(
    stack: &mut Stack<'_, Entry, STACK>,
    links: &[u32; W],
    t: &Entered<W>,
    first: Link,
    mut rest: u32,
) -> Link {
    while rest != 0 {
        let i = rest.trailing_zeros() as usize & (W - 1);
        rest &= rest - 1;
        stack.push(Entry { t: t.0[i], link: Link(links[i]) });
    }
    first
}

/// Puts all but the nearest child on the stack, the farthest first; returns the nearest.
#[inline(always)]
pub(super) fn push_in_order<const W: usize>(
    stack: &mut Stack<'_, Entry, STACK>,
    links: &[u32; W],
    t: &Entered<W>,
    first: Entry,
    mut rest: u32,
) -> Link {
    let i = rest.trailing_zeros() as usize & (W - 1);
    rest &= rest - 1;
    let second = Entry { t: t.0[i], link: Link(links[i]) };
    let (mut near, far) = if second.t < first.t { (second, first) } else { (first, second) };
    if rest == 0 {
        stack.push(far);
        return near.link;
    }
    let bottom = stack.len();
    stack.push(far);
    while rest != 0 {
        let i = rest.trailing_zeros() as usize & (W - 1);
        rest &= rest - 1;
        let entry = Entry { t: t.0[i], link: Link(links[i]) };
        if entry.t < near.t {
            stack.push(near);
            near = entry;
        } else {
            stack.insert(bottom, entry, |a, b| a.t < b.t);
        }
    }
    near.link
}
