//! How often sampled rays visit the nodes of a binary tree: what areas stand in for where no rays are known.

use super::binary::BinaryNode;
use crate::error::Result;
use crate::heuristic::{Heuristic, Rdh, Span};
use crate::mem::reserve;
use crate::options::Watch;

/// A child that none of a node's rays visits keeps this part of its chance by area. Were it 0, whatever is done below it would
/// cost nothing: no cut would be cheaper than another, and the first one, into nodes of two, would be taken.
const LEAST: f32 = 1e-4;

/// The chances that a ray which meets the root visits each node: sends the heuristic's rays down the tree, and tells those of each
/// node. O(R · nodes visited by a ray).
pub(crate) fn measure(
    nodes: &[BinaryNode],
    rdh: &Rdh,
    watch: &Watch<'_>,
    mut tell: impl FnMut(usize, &[Span]),
) -> Result<Vec<f32>> {
    let mut chances = Vec::new();
    reserve(&mut chances, nodes.len(), "visits")?;
    chances.resize(nodes.len(), 0.0);
    let Some(root) = nodes.first() else { return Ok(chances) };
    // One stack has the rays of all nodes that wait, and of those above them.
    let mut spans = rdh.root(&root.0.bounds()).spans;
    tell(0, &spans);
    let all = rdh.weigh_spans(&spans);
    chances[0] = 1.0;
    let mut todo = vec![(0, 0..spans.len(), all)];
    while let Some((node, rays, all)) = todo.pop() {
        watch.check_at(node)?;
        spans.truncate(rays.end);
        if !nodes[node].is_interior() {
            continue;
        }
        for child in [nodes[node].right(), node + 1] {
            let start = spans.len();
            rdh.descend_in(&mut spans, rays.clone(), &nodes[child].0.bounds());
            let of_child = &spans[start..];
            tell(child, of_child);
            let part = rdh.weigh_spans(of_child);
            let area = ratio(nodes[child].0.half_area(), nodes[node].0.half_area());
            chances[child] = chances[node] * rdh.chance(part, all, area).max(LEAST * area);
            todo.push((child, start..spans.len(), part));
        }
    }
    Ok(chances)
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

    fn measured(spec: &RdhSpec, training: Training) -> Vec<f32> {
        let (rdh, options) = (Rdh::new(spec, &training, 1.0), BuildOptions::default());
        let mut told = Vec::new();
        let chances = measure(&tree(), &rdh, &Watch::new(&options, 2), |node, _| told.push(node)).unwrap();
        told.sort_unstable();
        assert_eq!(told, [0, 1, 2], "each node is told once");
        chances
    }

    #[test]
    fn rays_that_end_in_the_first_box_do_not_visit_the_second() {
        // Three rays along x end in the first cube, one across goes through the second.
        let along = sample([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], Some(1.5), Query::Occluded);
        let across = sample([3.5, 0.5, -1.0], [0.0, 0.0, 1.0], None, Query::Closest);
        let training = Training::from_samples(vec![along, along, along, across]);
        let spec = RdhSpec { blend: crate::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::default() };
        assert_eq!(measured(&spec, training), [1.0, 0.75, 0.25]);
    }

    #[test]
    fn what_no_ray_visits_keeps_a_small_chance() {
        let along = sample([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], Some(1.5), Query::Closest);
        let spec = RdhSpec { blend: crate::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::default() };
        assert_eq!(measured(&spec, Training::from_samples(vec![along])), [1.0, 1.0, LEAST * (3.0 / 9.0)]);
    }

    #[test]
    fn areas_stand_in_where_no_ray_comes() {
        let elsewhere = sample([0.0, 9.0, 0.0], [1.0, 0.0, 0.0], None, Query::Closest);
        // Half areas: 3 of 9.
        assert_eq!(measured(&RdhSpec::default(), Training::from_samples(vec![elsewhere])), [1.0, 3.0 / 9.0, 3.0 / 9.0]);
    }
}
