//! The ray distribution heuristic (Bittner and Havran, SCCG 2009): count the sampled rays on each side of a plane.
//!
//! ```text
//! p_L = |R_L| / |R|,  p_R = |R_R| / |R|                                                                        (eq. 2)
//! ```
//! R: the sampled rays that cross the node; R_L, R_R: those that cross the left and the right part of it. A ray in
//! the plane counts on both sides. Both are blended with the areas' chances by the number of rays in the node, so that a
//! node without rays is split as SAH would.

use super::{Blend, Heuristic, NodeRays, RayExtent, RdhSpec, Sah, Span};
use crate::geom::{Aabb, Axis, Vec3};
use crate::rays::Training;

/// The ray distribution heuristic over one training set.
#[derive(Debug, Clone)]
pub struct Rdh {
    lines: Vec<Line>,
    blend: Blend,
    cap: usize,
}

/// A sampled ray in the structure's space.
#[derive(Debug, Clone, Copy)]
struct Line {
    origin: Vec3,
    direction: Vec3,
    /// Kept finite, so that no product with it is NaN.
    inverse: Vec3,
    t_start: f32,
    t_end: f32,
    weight: f32,
}

impl Rdh {
    /// Takes the rays into the space of a structure whose coordinates are multiplied by `scale`. Invalid rays are left out.
    pub fn new(spec: &RdhSpec, rays: &Training, scale: f32) -> Self {
        let usable = rays.samples().iter().filter(|s| s.ray.is_valid());
        let lines = usable.map(|s| {
            let reach = s.ray.direction.iter().fold(0.0f32, |m, x| m.max(x.abs()));
            let t_end = if spec.rays == RayExtent::Whole { f32::INFINITY } else { s.t_end() };
            // `t` counts in units of the largest component, so that every distance stays in range.
            let units = f64::from(reach) * f64::from(scale);
            Line {
                origin: s.ray.origin.map(|x| x * scale),
                direction: s.ray.direction.map(|x| x / reach),
                inverse: s
                    .ray
                    .direction
                    .map(|x| reach / if x.abs() > reach * 1e-15 { x } else { (reach * 1e-15).copysign(x) }),
                t_start: (f64::from(s.ray.t_min) * units) as f32,
                t_end: (f64::from(t_end) * units) as f32,
                weight: s.weight as f32,
            }
        });
        Self { lines: lines.collect(), blend: spec.blend, cap: spec.cap as usize }
    }

    /// The rays that are counted in a node: all, or the first few, which are a random sub-sample.
    fn counted<'a>(&self, rays: &'a NodeRays) -> &'a [Span] {
        let n = rays.spans.len();
        &rays.spans[..if self.cap == 0 { n } else { n.min(self.cap) }]
    }

    /// The part of a span that lies in a box; widened by an ulp or two, so that a ray in a face is in both boxes.
    fn clip(&self, span: Span, bounds: &Aabb) -> Option<Span> {
        let line = &self.lines[span.ray as usize];
        let (mut t_in, mut t_out) = (span.t_in, span.t_out);
        for a in 0..3 {
            let t0 = (bounds.min[a] - line.origin[a]) * line.inverse[a];
            let t1 = (bounds.max[a] - line.origin[a]) * line.inverse[a];
            t_in = t_in.max(t0.min(t1));
            t_out = t_out.min(t0.max(t1));
        }
        (t_in <= t_out + t_out.abs() * 3e-7).then_some(Span { t_in, t_out: t_out.max(t_in), ..span })
    }

    /// Weights of the rays on each side of ascending planes, with their ends on both. O(R log P + P).
    fn count(&self, spans: &[Span], axis: Axis, planes: &[f32], left: &mut [f32], right: &mut [f32]) {
        let a = axis.index();
        left.fill(0.0);
        right.fill(0.0);
        let mut right_of_all = 0.0;
        for span in spans {
            let line = &self.lines[span.ray as usize];
            let at = |t: f32| line.origin[a] + t * line.direction[a];
            let (x0, x1) = (at(span.t_in), at(span.t_out));
            // Left of the planes from `first_left` on, right of those before `first_missed`.
            let first_left = planes.partition_point(|&p| p < x0.min(x1));
            let first_missed = planes.partition_point(|&p| p <= x0.max(x1));
            if let Some(left) = left.get_mut(first_left) {
                *left += line.weight;
            }
            *right.get_mut(first_missed).unwrap_or(&mut right_of_all) += line.weight;
        }
        for i in 1..left.len() {
            left[i] += left[i - 1];
        }
        let mut sum = right_of_all;
        for right in right.iter_mut().rev() {
            sum += std::mem::replace(right, sum);
        }
    }
}

impl Heuristic for Rdh {
    fn root(&self, bounds: &Aabb) -> NodeRays {
        let whole = |(i, line): (usize, &Line)| Span { ray: i as u32, t_in: line.t_start, t_out: line.t_end };
        let spans = self.lines.iter().enumerate().map(whole).filter_map(|s| self.clip(s, bounds)).collect();
        NodeRays { spans }
    }

    fn descend(&self, rays: &NodeRays, child: &Aabb) -> NodeRays {
        NodeRays { spans: rays.spans.iter().filter_map(|&s| self.clip(s, child)).collect() }
    }

    fn sweep(&self, rays: &NodeRays, node: &Aabb, axis: Axis, planes: &[f32], left: &mut [f32], right: &mut [f32]) {
        Sah.sweep(rays, node, axis, planes, left, right);
        let spans = self.counted(rays);
        let total: f32 = spans.iter().map(|s| self.lines[s.ray as usize].weight).sum();
        let weight = self.blend.weight(total);
        // No rays, or none that count: the areas alone, bit for bit.
        if weight == 0.0 {
            return;
        }
        let mut order: Vec<u32> = (0..planes.len() as u32).collect();
        order.sort_by(|&i, &j| planes[i as usize].total_cmp(&planes[j as usize]));
        let ascending: Vec<f32> = order.iter().map(|&i| planes[i as usize]).collect();
        let (mut counts_left, mut counts_right) = (vec![0.0; planes.len()], vec![0.0; planes.len()]);
        self.count(spans, axis, &ascending, &mut counts_left, &mut counts_right);
        let mix = |count: f32, area: &mut f32| *area = weight * (count / total) + (1.0 - weight) * *area;
        for (k, &i) in order.iter().enumerate() {
            mix(counts_left[k], &mut left[i as usize]);
            mix(counts_right[k], &mut right[i as usize]);
        }
    }
}
