//! Growing ahead what sampled rays reach: on all threads at once, and with more care where they come often.

use rayon::prelude::*;

use super::ground::{Ground, WHOLE};
use super::part::Parting;
use super::runs;
use super::subtree::{Grown, Subtree};
use crate::bvh::{BvhSpec, ByArea, ByRays, Extent};
use crate::error::Result;
use crate::heuristic::{By, Heuristic, NodeRays, Rdh};
use crate::options::Watch;

/// So many triangles of a tree are worth more care if all rays visit it; fewer in proportion. What the quick builder spares is some
/// hundred nanoseconds a triangle, and what it costs is some nanoseconds a visit, so that a triangle must see some sixteen visits: of the
/// half a million rays of a small picture.
const TRIANGLES_WORTH_CARE: f32 = (1 << 15) as f32;

/// What grows ahead.
pub(super) struct Ahead<'a> {
    pub(super) ground: &'a Ground,
    pub(super) rdh: &'a Rdh,
    /// The weight of all its rays.
    pub(super) all: f32,
    /// How trees are built that many rays visit.
    pub(super) careful: &'a BvhSpec,
    pub(super) parallel: bool,
    pub(super) watch: &'a Watch<'a>,
}

impl Ahead<'_> {
    /// Grows a subtree and what lies below it, as far as its rays reach.
    ///
    /// # Errors
    /// Cancellation.
    pub(super) fn grow(&self, subtree: &Subtree, rays: &NodeRays) -> Result<()> {
        self.watch.check_cancelled()?;
        if rays.is_empty() {
            return Ok(());
        }
        let grown = subtree.grow_alone(|runs| self.grown(runs, subtree.depth(), rays));
        let Grown::Node(node) = grown else { return Ok(()) };
        let child = |(lane, child): (usize, &Subtree)| self.grow(child, &self.rdh.descend(rays, &node.boxes.get(lane)));
        if self.parallel {
            node.children.par_iter().enumerate().try_for_each(child)
        } else {
            node.children.iter().enumerate().try_for_each(child)
        }
    }

    fn grown(&self, runs: &mut [Extent], depth: u32, rays: &NodeRays) -> Option<Grown> {
        let n = runs::count(runs);
        if n <= WHOLE {
            return self.tree(runs, n, rays);
        }
        let (level, parallel) = (self.ground.level(), self.parallel);
        match self.rdh.stages().splits {
            By::Rays => {
                let chooser = &ByRays(self.rdh);
                self.ground.node(runs, depth, &Parting { chooser, level, parallel }, rays.clone())
            }
            By::Areas => self.ground.node(runs, depth, &Parting { chooser: &ByArea, level, parallel }, ()),
        }
    }

    /// With care for these rays, if there are many.
    fn tree(&self, runs: &[Extent], n: usize, rays: &NodeRays) -> Option<Grown> {
        if self.rdh.weigh_node(rays) * TRIANGLES_WORTH_CARE < self.all * n as f32 {
            return self.ground.tree(runs, self.ground.spec(), None);
        }
        self.ground.tree(runs, self.careful, Some(&self.rdh.within(rays)))
    }
}
