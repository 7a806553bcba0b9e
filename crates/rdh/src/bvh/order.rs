//! In which order a wide node's children are tried by rays that any hit will stop: the order that would have cost sampled rays least.
//!
//! A static order for all rays, as in Ogaki and Derouet-Jourdan, *An N-ary BVH Child Node Sorting Technique for Occlusion Rays* (JCGT
//! 2016). Here nothing is modelled: each sampled ray is sent through the whole tree, as if nothing stopped it, and what it
//! would find and pay below each child is known before children are ordered, from the leaves up.
//! ```text
//! visit(node, rays):
//!     for each child: the rays that meet its box; whether they are stopped below it, and at what cost        (visit, or tests)
//!     take the child that stops most of the rays that are left for what it costs them; again, without those it stops
//! ```
//! The greedy choice costs at most four times as much as the best order (Feige, Lovász and Tetali 2004), and usually the same.

use super::binary::BinaryNode;
use super::collapse::{Costs, Cuts};
use crate::error::Result;
use crate::geom::{Aabb, PlaneFrame, Ray, Scale};
use crate::heuristic::Rdh;
use crate::options::Watch;
use crate::simd::LANES;

/// More rays than this change no order that matters.
const MOST: usize = 1024;
/// What areas promise counts as so many rays.
const PRIOR: f32 = 1.0;

/// A sampled ray that asks only whether anything is in its way, in the tree's space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asker {
    /// With its own interval, whatever it hit.
    pub(crate) ray: Ray,
    frame: PlaneFrame,
    /// How many rays it stands for.
    weight: f32,
}

impl Asker {
    /// Those of a heuristic's rays, for a tree within `magnitude` of the origin.
    pub(crate) fn all(rdh: &Rdh, magnitude: f32) -> Vec<Self> {
        // The rays are in the tree's space already.
        let one = Scale::of(&Aabb::EMPTY);
        let asker = |(ray, weight)| Self { ray, frame: PlaneFrame::new(&ray, one, magnitude), weight };
        rdh.any_hit_rays().take(MOST).map(asker).collect()
    }
}

/// What becomes of a ray below a node.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    cost: f32,
    stopped: bool,
}

/// A ray that met a child.
struct Meeting {
    /// Which of the node's rays.
    ray: usize,
    outcome: Outcome,
}

/// What all nodes share.
struct Trial<'a, F, const W: usize> {
    nodes: &'a [BinaryNode],
    cuts: &'a Cuts<W>,
    costs: Costs,
    askers: &'a [Asker],
    /// Whether a ray hits one of a leaf's triangles: those of a binary node.
    hits: F,
    watch: &'a Watch<'a>,
}

/// Puts into `scores`, which come with what is known without a trial, higher numbers for children that are to be tried earlier, wherever rays
/// come. O(R · nodes that a ray meets).
pub(crate) fn score<const W: usize>(
    nodes: &[BinaryNode],
    cuts: &Cuts<W>,
    costs: Costs,
    askers: &[Asker],
    hits: impl Fn(&Asker, usize) -> bool,
    scores: &mut [f32],
    watch: &Watch<'_>,
) -> Result<()> {
    if nodes.is_empty() || askers.is_empty() || cuts.is_leaf(nodes, 0) {
        return Ok(());
    }
    let all: Vec<u32> = (0..askers.len() as u32).collect();
    Trial { nodes, cuts, costs, askers, hits, watch }.visit(0, &all, scores).map(|_| ())
}

impl<F: Fn(&Asker, usize) -> bool, const W: usize> Trial<'_, F, W> {
    /// Orders what lies below a node; the outcomes of the rays that meet its box, in their order.
    fn visit(&self, node: usize, rays: &[u32], scores: &mut [f32]) -> Result<Vec<Outcome>> {
        self.watch.check_at(node)?;
        let (children, n) = self.cuts.children(self.nodes, node);
        let mut met: [Vec<Meeting>; W] = std::array::from_fn(|_| Vec::new());
        for (&child, met) in children[..n].iter().zip(&mut met) {
            *met = self.meet(child, rays, scores)?;
        }
        let order = self.order(node, &children[..n], &met[..n], rays);
        let mut outcomes = vec![Outcome { cost: self.costs.node, stopped: false }; rays.len()];
        for (place, &i) in order.iter().enumerate().take(n) {
            scores[children[i]] = (n - place) as f32;
            for meeting in &met[i] {
                let outcome = &mut outcomes[meeting.ray];
                if !outcome.stopped {
                    outcome.cost += meeting.outcome.cost;
                    outcome.stopped = meeting.outcome.stopped;
                }
            }
        }
        Ok(outcomes)
    }

    /// The rays of a node that meet a child's box, and what becomes of them there.
    fn meet(&self, child: usize, rays: &[u32], scores: &mut [f32]) -> Result<Vec<Meeting>> {
        let bounds = self.nodes[child].0.bounds();
        let meets = |&(_, &ray): &(usize, &u32)| {
            let (near, far) = self.askers[ray as usize].frame.span(&bounds);
            near <= far
        };
        let (places, rays): (Vec<usize>, Vec<u32>) =
            rays.iter().enumerate().filter(meets).map(|(i, &r)| (i, r)).unzip();
        if rays.is_empty() {
            return Ok(Vec::new());
        }
        let outcomes = if self.cuts.is_leaf(self.nodes, child) {
            let cost = self.costs.test * self.cuts.count(child).div_ceil(LANES as u32) as f32;
            rays.iter().map(|&r| Outcome { cost, stopped: (self.hits)(&self.askers[r as usize], child) }).collect()
        } else {
            self.visit(child, &rays, scores)?
        };
        Ok(places.into_iter().zip(outcomes).map(|(ray, outcome)| Meeting { ray, outcome }).collect())
    }

    /// The children's numbers, in the order in which they are to be tried.
    fn order(&self, node: usize, children: &[usize], met: &[Vec<Meeting>], rays: &[u32]) -> [usize; W] {
        let share = |i: usize| part(&self.nodes[children[i]], &self.nodes[node]);
        let weight = |meeting: &Meeting| self.askers[rays[meeting.ray] as usize].weight;
        let average = average_cost(met.iter().flatten().map(|m| (weight(m), m.outcome.cost)));
        let mut order: [usize; W] = std::array::from_fn(|i| i);
        let mut done = vec![false; rays.len()];
        for place in 0..children.len() {
            let worth = |i: usize| {
                let (mut stopped, mut cost) = (PRIOR * share(i), PRIOR * average);
                for meeting in met[i].iter().filter(|m| !done[m.ray]) {
                    cost += weight(meeting) * meeting.outcome.cost;
                    stopped += if meeting.outcome.stopped { weight(meeting) } else { 0.0 };
                }
                stopped / cost
            };
            let (mut best, mut most) = (place, worth(order[place]));
            for (other, &child) in order.iter().enumerate().take(children.len()).skip(place + 1) {
                let worth = worth(child);
                if worth > most {
                    (best, most) = (other, worth);
                }
            }
            // What is left keeps its order.
            order[place..=best].rotate_right(1);
            met[order[place]].iter().filter(|m| m.outcome.stopped).for_each(|m| done[m.ray] = true);
        }
        order
    }
}

/// A child's part of its node's area.
fn part(child: &BinaryNode, node: &BinaryNode) -> f32 {
    let whole = node.0.half_area();
    if whole > 0.0 { (child.0.half_area() / whole).min(1.0) } else { 1.0 }
}

/// Of weighted costs; 1 without any.
fn average_cost(costs: impl Iterator<Item = (f32, f32)>) -> f32 {
    let (weights, sum) =
        costs.fold((0.0, 0.0), |(weights, sum), (weight, cost)| (weights + weight, sum + weight * cost));
    if weights > 0.0 { sum / weights } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::extent::Extent;
    use crate::heuristic::RdhSpec;
    use crate::options::BuildOptions;
    use crate::rays::{Query, RayClass, RaySample, Training};

    const COSTS: Costs = Costs { node: 1.0, test: 0.6 };

    /// Boxes along x at 0, 2 and 4, the last one twice as long; only what lies in the middle one stops rays.
    fn scores(rays: &[Ray]) -> Vec<f32> {
        let at = |x: f32, width: f32| Extent::new(&Aabb { min: [x, 0.0, 0.0], max: [x + width, 1.0, 1.0] }, 0, 0);
        let leaf = |i: usize, width| BinaryNode::leaf(at(2.0 * i as f32, width), 8 * i, 8);
        let [first, middle, last] = [leaf(0, 1.0), leaf(1, 1.0), leaf(2, 2.0)];
        let nodes = [BinaryNode::interior(at(0.0, 6.0), 2), first, BinaryNode::interior(at(2.0, 4.0), 4), middle, last];
        let sample = |&ray| RaySample { ray, t_hit: None, query: Query::Occluded, class: RayClass::Shadow, weight: 1 };
        let rdh = Rdh::new(&RdhSpec::default(), &Training::from_samples(rays.iter().map(sample).collect()), 1.0);
        let options = BuildOptions::default();
        let watch = Watch::new(&options, 3);
        let cuts = Cuts::<8>::cheapest(&nodes, None, COSTS, |i| nodes[i].0.half_area(), false, &watch).unwrap();
        let mut scores: Vec<f32> = nodes.iter().map(|n| n.0.half_area()).collect();
        score(&nodes, &cuts, COSTS, &Asker::all(&rdh, 6.0), |_, leaf| leaf == 3, &mut scores, &watch).unwrap();
        scores
    }

    #[test]
    fn where_rays_are_stopped_comes_first_and_what_they_only_pass_last() {
        let along = Ray::new([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
        let across = Ray::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]);
        let scores = scores(&[along, along, across]);
        assert!(scores[3] > scores[4] && scores[4] > scores[1], "{scores:?}");
    }

    #[test]
    fn areas_decide_where_no_ray_comes() {
        let scores = scores(&[Ray::new([0.0, 9.0, 0.0], [1.0, 0.0, 0.0])]);
        assert!(scores[4] > scores[1] && scores[4] > scores[3], "{scores:?}");
    }
}
