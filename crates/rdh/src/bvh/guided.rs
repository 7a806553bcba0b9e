//! Splits by the sampled rays in a node, as far as there are enough of them.

use super::binary::{Chooser, Node};
use super::extent::Extent;
use super::split::{Asked, Search, Sides, Split};
use crate::geom::Aabb;
use crate::heuristic::{Heuristic, NodeRays, Ranks, Rdh};

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

    fn best(&self, search: &Search, primitives: &[Extent], node: &Node<NodeRays>, asked: Asked<'_>) -> Option<Split> {
        if node.rays.len() < FEW {
            return search.best(primitives, &node.centres, asked);
        }
        let (whole, rays) = (node.extent.half_area(), self.0.ranks(&node.rays));
        search.best_by(primitives, &node.centres, |Sides { lows, highs }, left, right| {
            self.chances(&rays, lows, whole, left);
            self.chances(&rays, highs, whole, right);
        })
    }
}

impl ByRays<'_> {
    /// The chances that a ray in a node visits each of some boxes in it: by areas relative to the node's, blended with its rays.
    fn chances(&self, rays: &Ranks, boxes: &[Extent], whole: f32, chances: &mut [f32]) {
        // Some of the first or of the last may be empty: these are no choice.
        let is_there = |extent: &&Extent| !extent.is_empty();
        let bounds: Vec<Aabb> = boxes.iter().filter(is_there).map(Extent::bounds).collect();
        let mut met = vec![0.0; bounds.len()];
        rays.weigh(&bounds, &mut met);
        let mut met = met.into_iter();
        for (chance, extent) in chances.iter_mut().zip(boxes).filter(|(_, extent)| !extent.is_empty()) {
            let area = if whole > 0.0 { extent.half_area() / whole } else { 1.0 };
            *chance = self.0.chance(met.next().unwrap_or_default(), rays.weight(), area);
        }
    }
}
