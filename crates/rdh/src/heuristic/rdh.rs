//! The ray distribution heuristic (Bittner and Havran, SCCG 2009): count the sampled rays on each side of a plane.
//!
//! ```text
//! p_L = |R_L| / |R|,  p_R = |R_R| / |R|                                                                        (eq. 2)
//! ```
//! R: the sampled rays that cross the node; R_L, R_R: those that cross the left and the right part of it. A ray in
//! the plane counts on both sides. Both are blended with the areas' chances by the number of rays in the node, so that a
//! node without rays is split as SAH would.

use super::blend::mix;
use super::{Blend, Heuristic, NodeRays, RayExtent, RdhSpec, Sah, Span, SplitProbability};
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

    /// Weights of the counted rays on each side of every plane, and their total. O(R log P + P).
    fn count(&self, spans: &[Span], axis: Axis, planes: &[f32], out: &mut [SplitProbability]) -> f32 {
        let a = axis.index();
        out.fill(SplitProbability::default());
        let mut total = 0.0;
        let mut right_of_all = 0.0;
        for span in spans {
            let line = &self.lines[span.ray as usize];
            let (x0, x1) =
                (line.origin[a] + span.t_in * line.direction[a], line.origin[a] + span.t_out * line.direction[a]);
            let (low, high) = (x0.min(x1), x0.max(x1));
            // Left of the planes from `first_left` on, right of those before `first_missed`.
            let first_left = planes.partition_point(|&p| p < low);
            let first_missed = planes.partition_point(|&p| p <= high);
            if let Some(p) = out.get_mut(first_left) {
                p.left += line.weight;
            }
            match out.get_mut(first_missed) {
                Some(p) => p.right += line.weight,
                None => right_of_all += line.weight,
            }
            total += line.weight;
        }
        let mut left = 0.0;
        for p in out.iter_mut() {
            left += p.left;
            p.left = left;
        }
        let mut right = right_of_all;
        for p in out.iter_mut().rev() {
            right += std::mem::replace(&mut p.right, right);
        }
        total
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

    fn sweep(&self, rays: &NodeRays, node: &Aabb, axis: Axis, planes: &[f32], out: &mut [SplitProbability]) {
        let spans = self.counted(rays);
        let total = self.count(spans, axis, planes, out);
        let weight = self.blend.weight(total);
        let mut areas = [SplitProbability::default(); 64];
        for (planes, out) in planes.chunks(64).zip(out.chunks_mut(64)) {
            Sah.sweep(rays, node, axis, planes, &mut areas[..planes.len()]);
            for (p, &area) in out.iter_mut().zip(&areas) {
                // No rays, or none that count: the areas alone, bit for bit.
                *p = if weight > 0.0 {
                    mix(weight, SplitProbability { left: p.left / total, right: p.right / total }, area)
                } else {
                    area
                };
            }
        }
    }
}
