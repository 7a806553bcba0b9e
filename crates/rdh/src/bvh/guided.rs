//! Splits by the sampled rays in a node, as far as there are enough of them.

use super::binary::{Chooser, Node};
use super::extent::Extent;
use super::split::{Search, Sides, Split};
use crate::geom::Aabb;
use crate::heuristic::{Heuristic, NodeRays, Rdh};

/// Splits for a heuristic's rays; by areas in nodes that hardly any of them visits.
pub(crate) struct ByRays<'a>(pub(crate) &'a Rdh);

/// Fewer rays decide nothing: areas outweigh them.
const FEW: usize = 16;

impl Chooser for ByRays<'_> {
    type Rays = NodeRays;

    fn root(&self, extent: &Extent) -> NodeRays {
        self.0.root(&extent.bounds())
    }

    fn descend(&self, rays: &NodeRays, child: &Extent) -> NodeRays {
        if rays.len() < FEW { NodeRays::default() } else { self.0.descend(rays, &child.bounds()) }
    }

    fn best(&self, search: &Search, primitives: &[Extent], node: &Node<NodeRays>) -> Option<Split> {
        if node.rays.len() < FEW {
            return search.best(primitives, &node.centres);
        }
        let whole = node.extent.half_area();
        search.best_by(primitives, &node.centres, |sides, left, right| {
            areas(sides.lows, whole, left);
            areas(sides.highs, whole, right);
            let Sides { lows, highs } = sides;
            let first = lows.iter().take_while(|b| is_empty(b)).count();
            let last = highs.len() - highs.iter().rev().take_while(|b| is_empty(b)).count();
            let lows: Vec<Aabb> = lows[first..].iter().map(Extent::bounds).collect();
            let highs: Vec<Aabb> = highs[..last].iter().rev().map(Extent::bounds).collect();
            self.0.weigh_nested(&node.rays, &lows, &mut left[first..]);
            right[..last].reverse();
            self.0.weigh_nested(&node.rays, &highs, &mut right[..last]);
            right[..last].reverse();
        })
    }
}

fn is_empty(extent: &Extent) -> bool {
    extent.bounds().is_empty()
}

/// Of boxes, relative to their node's.
fn areas(boxes: &[Extent], whole: f32, areas: &mut [f32]) {
    for (area, extent) in areas.iter_mut().zip(boxes) {
        *area = if whole > 0.0 { extent.half_area() / whole } else { 1.0 };
    }
}
