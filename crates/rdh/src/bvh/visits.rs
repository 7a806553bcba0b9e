//! How often sampled rays visit the nodes of a binary tree, and end in them: what areas stand in for where no rays are known.

use super::binary::BinaryNode;
use crate::error::Result;
use crate::heuristic::{Heuristic, NodeRays, Rdh};
use crate::mem::reserve;
use crate::options::Watch;

/// What is expected of each node of a binary tree, in its order.
pub(crate) struct Visits {
    /// The chance that a ray which meets the root visits the node.
    pub(crate) chances: Vec<f32>,
    /// The chance that a query for any hit ends there; areas stand in, weakly, where none of the sampled rays does.
    pub(crate) stops: Vec<f32>,
}

/// The weight of areas among stops, in rays.
const STOP_PRIOR: f32 = 1.0;
/// A child that none of a node's rays visits keeps this part of its chance by area. Were it 0, whatever is done below it would
/// cost nothing: no cut would be cheaper than another, and the first one, into nodes of two, would be taken.
const LEAST: f32 = 1e-4;

impl Visits {
    /// Areas for both.
    pub(crate) fn by_area(nodes: &[BinaryNode]) -> Result<Self> {
        let mut visits = Self::none(nodes.len())?;
        for (node, (chance, stop)) in nodes.iter().zip(visits.chances.iter_mut().zip(&mut visits.stops)) {
            let area = node.0.half_area();
            (*chance, *stop) = (area, area);
        }
        Ok(visits)
    }

    fn none(n: usize) -> Result<Self> {
        let (mut chances, mut stops) = (Vec::new(), Vec::new());
        reserve(&mut chances, n, "visits")?;
        reserve(&mut stops, n, "visits")?;
        chances.resize(n, 0.0);
        stops.resize(n, 0.0);
        Ok(Self { chances, stops })
    }

    /// Sends the heuristic's rays down the tree. O(R · nodes visited by a ray).
    pub(crate) fn measure(nodes: &[BinaryNode], rdh: &Rdh, watch: &Watch<'_>) -> Result<Self> {
        let mut visits = Self::none(nodes.len())?;
        let Some(root) = nodes.first() else { return Ok(visits) };
        let rays = rdh.root(&root.0.bounds());
        let (all, stopped) = rdh.weigh_node(&rays);
        let whole = root.0.half_area();
        (visits.chances[0], visits.stops[0]) = (1.0, 1.0);
        let mut todo = vec![(0, rays, all)];
        while let Some((node, rays, all)) = todo.pop() {
            watch.check_at(node)?;
            if !nodes[node].is_interior() {
                continue;
            }
            for child in [nodes[node].right(), node + 1] {
                let of_child =
                    if rays.is_empty() { NodeRays::default() } else { rdh.descend(&rays, &nodes[child].0.bounds()) };
                let (part, ended) = rdh.weigh_node(&of_child);
                let area = nodes[child].0.half_area();
                let of_node = ratio(area, nodes[node].0.half_area());
                let chance = rdh.chance(part, all, of_node).max(LEAST * of_node);
                visits.chances[child] = visits.chances[node] * chance;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::extent::Extent;
    use crate::geom::{Aabb, Ray};
    use crate::heuristic::RdhSpec;
    use crate::options::BuildOptions;
    use crate::rays::{Query, RayClass, RaySample, Training};

    /// A root over two unit cubes, at x = 0 and x = 3.
    fn tree() -> Vec<BinaryNode> {
        let at = |x: f32, width: f32| Extent::new(&Aabb { min: [x, 0.0, 0.0], max: [x + width, 1.0, 1.0] }, 0, 0);
        vec![
            BinaryNode::interior(at(0.0, 4.0), 2),
            BinaryNode::leaf(at(0.0, 1.0), 0, 1),
            BinaryNode::leaf(at(3.0, 1.0), 1, 1),
        ]
    }

    fn sample(origin: [f32; 3], direction: [f32; 3], t_hit: Option<f32>, query: Query) -> RaySample {
        RaySample { ray: Ray::new(origin, direction), t_hit, query, class: RayClass::Other, weight: 1 }
    }

    fn measured(spec: &RdhSpec, training: Training) -> Visits {
        let (rdh, options) = (Rdh::new(spec, &training, 1.0), BuildOptions::default());
        Visits::measure(&tree(), &rdh, &Watch::new(&options, 2)).unwrap()
    }

    #[test]
    fn rays_that_end_in_the_first_box_do_not_visit_the_second() {
        // Three rays along x end in the first cube, one across goes through the second.
        let along = sample([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], Some(1.5), Query::Occluded);
        let across = sample([3.5, 0.5, -1.0], [0.0, 0.0, 1.0], None, Query::Closest);
        let training = Training::from_samples(vec![along, along, along, across]);
        let spec = RdhSpec { blend: crate::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::default() };
        let visits = measured(&spec, training);
        assert_eq!(visits.chances, [1.0, 0.75, 0.25]);
        assert!(visits.stops[1] > 0.75 && visits.stops[2] < 0.25, "{:?}", visits.stops);
    }

    #[test]
    fn what_no_ray_visits_keeps_a_small_chance() {
        let along = sample([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], Some(1.5), Query::Closest);
        let spec = RdhSpec { blend: crate::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::default() };
        let visits = measured(&spec, Training::from_samples(vec![along]));
        assert_eq!(visits.chances, [1.0, 1.0, LEAST * (3.0 / 9.0)]);
    }

    #[test]
    fn areas_stand_in_where_no_ray_comes() {
        let elsewhere = sample([0.0, 9.0, 0.0], [1.0, 0.0, 0.0], None, Query::Closest);
        let visits = measured(&RdhSpec::default(), Training::from_samples(vec![elsewhere]));
        // Half areas: 3 of 9.
        assert_eq!(visits.chances, [1.0, 3.0 / 9.0, 3.0 / 9.0]);
    }
}
