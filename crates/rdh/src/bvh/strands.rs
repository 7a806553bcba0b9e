//! Rays without order: several take turns, a step each, so that each waits for memory while the others compute.
//!
//! Which node comes next is known a turn before it is needed, and asked for at once. Neighbours in such a batch visit other parts of
//! the tree, so that caches and guesses about branches help little anyway; of rays in order this would make worse use.

use super::Bvh;
use super::leaves::{AnyLeaves, Corners};
use super::link::Link;
use super::recent::Recent;
use super::trace::{Caster, Entry, STACK, Watertight, push_all, push_in_order};
use crate::geom::Ray;
use crate::leaf::Collector;
use crate::mem::{Slots, Stack};
use crate::simd::{Block, Entered, Kernels, prefetch};

/// Rays that take turns.
const STRANDS: usize = 8;

/// A ray on its way.
struct Strand<'a, K: Kernels, C> {
    caster: Watertight<'a, K, C>,
    /// Which of the batch's rays it is.
    ray: u32,
    /// Where it goes next.
    link: Link,
}

/// Casts some of a batch's rays, and hands over what each has collected; if wanted, notes what they visit.
#[inline(always)]
pub(super) fn cast<K: Kernels, C: Collector<Start = ()>>(
    tree: &Bvh<8, AnyLeaves>,
    rays: &[Ray],
    which: &[u32],
    mut recent: Option<&mut Recent>,
    mut done: impl FnMut(u32, C::Output),
) {
    let mut slots = [const { Slots::<Entry, STACK>::new() }; STRANDS];
    let mut stacks = slots.each_mut().map(Slots::stack);
    let mut strands: [Option<Strand<'_, K, C>>; STRANDS] = [const { None }; STRANDS];
    let (mut scratch, mut t) = (bytemuck::Zeroable::zeroed(), Entered([0.0; 8]));
    let (mut waiting, mut live) = (which.iter(), STRANDS);
    while live > 0 {
        live = 0;
        for (strand, stack) in strands.iter_mut().zip(&mut stacks) {
            let goes_on = match strand {
                Some(strand) => {
                    if let Some(recent) = &mut recent {
                        recent.visit(strand.link);
                    }
                    strand.step(tree, stack, &mut t, &mut scratch)
                }
                None => false,
            };
            if !goes_on {
                if let Some(Strand { caster, ray, .. }) = strand.take() {
                    done(ray, caster.finish());
                }
                for &ray in waiting.by_ref() {
                    match Watertight::new(tree, &rays[ray as usize], ()) {
                        Ok(caster) => {
                            *strand = Some(Strand { caster, ray, link: Link::node(0) });
                            break;
                        }
                        Err(nothing) => done(ray, nothing),
                    }
                }
            }
            live += usize::from(strand.is_some());
        }
    }
}

impl<K: Kernels, C: Collector> Strand<'_, K, C> {
    /// Visits a node or a leaf, and asks for what comes next; whether there is anything.
    #[inline(always)]
    fn step(
        &mut self,
        tree: &Bvh<8, AnyLeaves>,
        stack: &mut Stack<'_, Entry, STACK>,
        t: &mut Entered<8>,
        scratch: &mut Block,
    ) -> bool {
        if self.link.is_leaf() {
            let block = tree.leaves.corners::<K>(self.link.block(), scratch);
            if !Caster::<8>::test(&mut self.caster, block, self.link.lanes()) {
                stack.clear();
                return false;
            }
        } else {
            let node = &tree.nodes[self.link.index()];
            let met = self.caster.meet(node, t);
            if met != 0 {
                let first = met.trailing_zeros() as usize & 7;
                let (link, rest) = (Link(node.links[first]), met & (met - 1));
                self.link = if rest == 0 {
                    link
                } else if C::ANY {
                    push_all(stack, &node.links, t, link, rest)
                } else {
                    push_in_order(stack, &node.links, t, Entry { t: t.0[first], link }, rest)
                };
                self.ask(tree);
                return true;
            }
        }
        while let Some(entry) = stack.pop() {
            if !C::ANY && entry.t > Caster::<8>::end(&self.caster) {
                continue;
            }
            self.link = entry.link;
            self.ask(tree);
            return true;
        }
        false
    }

    #[inline(always)]
    fn ask(&self, tree: &Bvh<8, AnyLeaves>) {
        if self.link.is_leaf() {
            tree.leaves.prefetch(self.link.block());
        } else {
            prefetch(&tree.nodes[self.link.index()]);
        }
    }
}
