//! How often sampled rays visit the nodes of a binary tree, and end in them: what areas stand in for where no rays are known.

use super::binary::BinaryNode;
use crate::error::Result;
use crate::heuristic::{Heuristic, NodeRays, Rdh};
use crate::mem::reserve;

/// What is expected of each node of a binary tree, in its order.
pub(crate) struct Visits {
    /// The chance that a ray which meets the root visits the node.
    pub(crate) chances: Vec<f32>,
    /// The chance that a query for any hit ends there; areas stand in, weakly, where none of the sampled rays does.
    pub(crate) stops: Vec<f32>,
}

/// The weight of areas among stops, in rays.
const STOP_PRIOR: f32 = 1.0;

impl Visits {
    /// Areas for both.
    pub(crate) fn by_area(nodes: &[BinaryNode]) -> Result<Self> {
        let mut areas = Vec::new();
        reserve(&mut areas, nodes.len(), "visits")?;
        areas.extend(nodes.iter().map(|node| node.0.half_area()));
        Ok(Self { stops: areas.clone(), chances: areas })
    }

    /// Sends the heuristic's rays down the tree. O(R · nodes visited by a ray).
    pub(crate) fn measure(nodes: &[BinaryNode], rdh: &Rdh) -> Result<Self> {
        let (mut chances, mut stops) = (Vec::new(), Vec::new());
        reserve(&mut chances, nodes.len(), "visits")?;
        reserve(&mut stops, nodes.len(), "visits")?;
        chances.resize(nodes.len(), 0.0);
        stops.resize(nodes.len(), 0.0);
        let mut visits = Self { chances, stops };
        let Some(root) = nodes.first() else { return Ok(visits) };
        let rays = rdh.root(&root.0.bounds());
        let (all, stopped) = rdh.weigh_node(&rays);
        let whole = root.0.half_area();
        (visits.chances[0], visits.stops[0]) = (1.0, 1.0);
        let mut todo = vec![(0, rays, all)];
        while let Some((node, rays, all)) = todo.pop() {
            if !nodes[node].is_interior() {
                continue;
            }
            for child in [nodes[node].right(), node + 1] {
                let of_child = if rays.is_empty() { NodeRays::default() } else { rdh.descend(&rays, &nodes[child].0.bounds()) };
                let (part, ended) = rdh.weigh_node(&of_child);
                let area = nodes[child].0.half_area();
                let of_node = ratio(area, nodes[node].0.half_area());
                visits.chances[child] = visits.chances[node] * rdh.chance(part, all, of_node);
                visits.stops[child] = (ended + STOP_PRIOR * ratio(area, whole)) / (stopped + STOP_PRIOR);
                todo.push((child, of_child, part));
            }
        }
        Ok(visits)
    }
}

/// Of areas; a flat node's parts are all of it.
fn ratio(part: f32, whole: f32) -> f32 {
    if whole > 0.0 { (part / whole).min(1.0) } else { 1.0 }
}
