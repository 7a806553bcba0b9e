//! Rays through the tree: nearest boxes first, without recursion or allocation.
//!
//! A box counts as wide as the slack of [`PlaneFrame`](crate::geom::PlaneFrame) on every side: each triangle that THE triangle test
//! would accept lies in boxes that the ray, so thickened, meets on the whole way from the root, not after the hit
//! (docs/watertight.md). Which boxes are met beyond that may differ between instruction sets; hits may not.

use super::Bvh;
use super::binary::DEEPEST;
use super::link::Link;
use crate::geom::Ray;
use crate::leaf::{Collector, Tester};
use crate::mem::{Slots, Stack};
use crate::probe::Probe;
use crate::simd::{Entered, Job, Kernels, guessed};

/// One ray's way through a tree.
pub(crate) struct Walk<'a, P, C: Collector, const W: usize> {
    pub(crate) tree: &'a Bvh<W>,
    pub(crate) ray: &'a Ray,
    pub(crate) probe: &'a mut P,
    pub(crate) start: C::Start,
}

/// A child to be visited, and where the ray enters its box.
#[derive(Debug, Clone, Copy)]
struct Entry {
    t: f32,
    link: Link,
}

/// The most entries that wait: all children but one of each node on the way down, and what was popped last.
const STACK: usize = 7 * DEEPEST as usize + 8;

impl<P: Probe, C: Collector, const W: usize> Job for Walk<'_, P, C, W> {
    /// What was collected.
    type Output = C::Output;

    #[inline(always)]
    fn run<K: Kernels>(self) -> C::Output {
        let Self { tree, ray, probe, start } = self;
        let mut collector = C::new(start);
        let Some(mut boxes) = K::box_ray(ray, tree.scale, tree.magnitude) else { return collector.finish() };
        let mut tester = Tester::<K>::new(ray, tree.masks.as_deref());
        let nodes = &tree.nodes[..];
        let mut slots = Slots::<Entry, STACK>::new();
        let mut stack = slots.stack();
        let mut link = Link::node(0);
        let mut t = Entered([0.0; W]);
        loop {
            if !link.is_leaf() {
                probe.interior();
                let node = &nodes[link.index()];
                let met = guessed(K::meet(&boxes, node, &mut t));
                if met != 0 {
                    let first = met.trailing_zeros() as usize & (W - 1);
                    let rest = met & (met - 1);
                    link = Link(node.links[first]);
                    if rest == 0 {
                        continue;
                    }
                    if C::ANY {
                        link = push_all(&mut stack, &node.links, &t, link, rest);
                    } else {
                        link = push_in_order(&mut stack, &node.links, &t, Entry { t: t.0[first], link }, rest);
                    }
                    continue;
                }
            } else {
                probe.leaf(link.count());
                match tester.test(&tree.blocks[link.block()], link.lanes(), &mut collector) {
                    Some(true) => K::end_at(&mut boxes, tester.t_max()),
                    Some(false) => {}
                    None => return collector.finish(),
                }
            }
            link = loop {
                match stack.pop() {
                    None => return collector.finish(),
                    Some(entry) if !C::ANY && entry.t > K::end(&boxes) => {}
                    Some(entry) => break entry.link,
                }
            };
        }
    }
}

/// Any hit will do: the likeliest child comes first, in the order of the lanes.
#[inline(always)]
fn push_all<const W: usize>(
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
fn push_in_order<const W: usize>(
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
