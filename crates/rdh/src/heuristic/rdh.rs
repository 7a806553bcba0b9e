//! The ray distribution heuristic (Bittner and Havran, SCCG 2009): count the sampled rays on each side of a plane.
//!
//! ```text
//! p_L = |R_L| / |R|,  p_R = |R_R| / |R|                                                                        (eq. 2)
//! ```
//! R: the sampled rays that cross the node; R_L, R_R: those that cross the left and the right part of it. A ray in
//! the plane counts on both sides. Both are blended with the areas' chances by the number of rays in the node, so that a
//! node without rays is split as SAH would.

use std::ops::Range;

use super::ranks::{Piece, Ranks};
use super::{Blend, Heuristic, NodeRays, RayExtent, RdhSpec, Sah, Span, Stages};
use crate::geom::{Aabb, Axis, Ray, Vec3};
use crate::rays::{Query, Training};
use crate::simd::{Job, Kernels, Level};

/// The ray distribution heuristic over one training set.
#[derive(Debug, Clone)]
pub struct Rdh {
    lines: Vec<Line>,
    blend: Blend,
    cap: usize,
    stages: Stages,
    level: Level,
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
    /// Its own end, wherever it hit something.
    t_far: f32,
    /// Of a ray that any hit would stop, the mask of triangles that it sees.
    asks: Option<u32>,
}

impl Line {
    fn whole(&self, ray: u32) -> Span {
        Span { ray, t_in: self.t_start, t_out: self.t_end }
    }
}

impl Rdh {
    /// Rays counted in a node of a kd-tree, unless the spec says otherwise.
    pub const CAP: u32 = 4096;

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
                t_far: (f64::from(s.ray.t_max) * units) as f32,
                asks: (s.query == Query::Occluded).then_some(s.ray.mask),
            }
        });
        Self {
            lines: lines.collect(),
            blend: spec.blend,
            cap: spec.cap.unwrap_or(Self::CAP) as usize,
            stages: spec.stages,
            level: Level::best(),
        }
    }

    /// What is to be decided by the rays.
    pub(crate) fn stages(&self) -> Stages {
        self.stages
    }

    /// Whole rays side by side.
    pub(crate) fn whole(&self, rays: &[u32]) -> Ranks {
        self.side_by_side(rays.iter().map(|&ray| self.lines[ray as usize].whole(ray)))
    }

    /// The counted rays of a node side by side.
    pub(crate) fn ranks(&self, rays: &NodeRays) -> Ranks {
        self.side_by_side(self.counted(rays).iter().copied())
    }

    fn side_by_side(&self, spans: impl Iterator<Item = Span>) -> Ranks {
        let piece = |span: Span| {
            let Line { origin, inverse, weight, .. } = self.lines[span.ray as usize];
            Piece { origin, inverse, t_in: span.t_in, t_out: span.t_out, weight }
        };
        Ranks::new(spans.map(piece), self.level)
    }

    /// The same over a fair part of the rays.
    pub(crate) fn thinned(&self, most: usize) -> Self {
        Self { lines: self.lines[..most.min(self.lines.len())].to_vec(), ..*self }
    }

    /// The same over the rays in a node alone.
    pub(crate) fn within(&self, rays: &NodeRays) -> Self {
        Self { lines: rays.spans.iter().map(|span| self.lines[span.ray as usize]).collect(), ..*self }
    }

    /// The same, counted with other instructions.
    pub(crate) fn with_level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The rays that are counted in a node: all, or the first few, which are a random sub-sample.
    fn counted<'a>(&self, rays: &'a NodeRays) -> &'a [Span] {
        let n = rays.spans.len();
        &rays.spans[..if self.cap == 0 { n } else { n.min(self.cap) }]
    }

    /// The sampled rays that any hit will stop, in the structure's space, with their weights.
    pub(crate) fn any_hit_rays(&self) -> impl Iterator<Item = (Ray, f32)> {
        self.lines.iter().filter_map(|line| {
            let Line { origin, direction, t_start: t_min, t_far: t_max, .. } = *line;
            Some((Ray { origin, direction, t_min, t_max, mask: line.asks? }, line.weight))
        })
    }

    /// The weight of a node's rays.
    pub(crate) fn weigh_node(&self, rays: &NodeRays) -> f32 {
        self.weigh_spans(&rays.spans)
    }

    /// The weight of some rays.
    pub(crate) fn weigh_spans(&self, spans: &[Span]) -> f32 {
        spans.iter().map(|span| self.lines[span.ray as usize].weight).sum()
    }

    /// Adds those of some spans that meet a box to a list that has their node's from `of` on; the others are left out.
    pub(crate) fn descend_in(&self, spans: &mut Vec<Span>, of: Range<usize>, child: &Aabb) {
        let (start, n) = (spans.len(), of.len());
        spans.resize(start + n, Span::default());
        let (before, new) = spans.split_at_mut(start);
        let met = self.clip_all(&before[of], child, new);
        spans.truncate(start + met);
    }

    /// The parts of spans that lie in a box, one after the other; how many there are. No branch: half of them are guessed wrong.
    fn clip_all(&self, spans: &[Span], bounds: &Aabb, clipped: &mut [Span]) -> usize {
        let mut n = 0;
        for &span in spans {
            let (part, meets) = self.clip(span, bounds);
            clipped[n] = part;
            n += usize::from(meets);
        }
        n
    }

    /// The chance that a ray in a node visits a child: `part` of `all` rays do, of the node's area the child has `area`.
    pub(crate) fn chance(&self, part: f32, all: f32, area: f32) -> f32 {
        match self.blend.weight(all) {
            0.0 => area,
            weight => mix(weight, part / all, area),
        }
    }

    /// The part of a span that lies in a box, and whether there is one; widened by an ulp or two, so that a ray in a face is in both
    /// boxes.
    #[inline(always)]
    fn clip(&self, span: Span, bounds: &Aabb) -> (Span, bool) {
        let line = &self.lines[span.ray as usize];
        let (mut t_in, mut t_out) = (span.t_in, span.t_out);
        for a in 0..3 {
            let t0 = (bounds.min[a] - line.origin[a]) * line.inverse[a];
            let t1 = (bounds.max[a] - line.origin[a]) * line.inverse[a];
            let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
            t_in = if t_in > near { t_in } else { near };
            t_out = if t_out < far { t_out } else { far };
        }
        let meets = t_in <= t_out + t_out.abs() * 3e-7;
        (Span { t_in, t_out: if t_out > t_in { t_out } else { t_in }, ..span }, meets)
    }

    /// The lowest and the highest point of a span along an axis, and its weight.
    #[inline(always)]
    fn extent(&self, span: &Span, a: usize) -> (f32, f32, f32) {
        let line = &self.lines[span.ray as usize];
        let x0 = line.origin[a] + span.t_in * line.direction[a];
        let x1 = line.origin[a] + span.t_out * line.direction[a];
        (x0.min(x1), x0.max(x1), line.weight)
    }

    /// Weights of a few rays on each side of the planes: each ray is compared with each plane, in lanes. O(64 P).
    fn weigh_few(&self, spans: &[Span], axis: Axis, planes: &[f32], left: &mut [f32], right: &mut [f32]) {
        let n = spans.len();
        let (mut low, mut high, mut weight) = ([0.0; FEW], [0.0; FEW], [0.0; FEW]);
        for (i, span) in spans.iter().enumerate() {
            (low[i], high[i], weight[i]) = self.extent(span, axis.index());
        }
        let (low, high, weight) = (&low[..n], &high[..n], &weight[..n]);
        self.level.run(Weigh { low, high, weight, planes, left, right });
    }

    /// The same for many rays: planes in order, two searches a ray, and running sums. O((R + P) log P).
    fn weigh_many(&self, spans: &[Span], axis: Axis, planes: &[f32], left: &mut [f32], right: &mut [f32]) {
        let mut order: Vec<u32> = (0..planes.len() as u32).collect();
        order.sort_by(|&i, &j| planes[i as usize].total_cmp(&planes[j as usize]));
        let ascending: Vec<f32> = order.iter().map(|&i| planes[i as usize]).collect();
        let (mut starts, mut ends) = (vec![0.0; planes.len() + 1], vec![0.0; planes.len() + 1]);
        for span in spans {
            let (low, high, weight) = self.extent(span, axis.index());
            // Left of the planes from the first on that is not below it, right of those that are not above it.
            starts[ascending.partition_point(|&p| p < low)] += weight;
            ends[ascending.partition_point(|&p| p <= high)] += weight;
        }
        let mut sum = 0.0;
        for (k, &i) in order.iter().enumerate() {
            sum += starts[k];
            left[i as usize] = sum;
        }
        let mut sum = 0.0;
        for (k, &i) in order.iter().enumerate().rev() {
            sum += ends[k + 1];
            right[i as usize] = sum;
        }
    }
}

/// Rays and areas, by the rays' weight.
fn mix(weight: f32, rays: f32, area: f32) -> f32 {
    weight * rays + (1.0 - weight) * area
}

/// Up to so many rays are compared with every plane.
const FEW: usize = 64;

/// Compares each ray with each plane.
struct Weigh<'a> {
    low: &'a [f32],
    high: &'a [f32],
    weight: &'a [f32],
    planes: &'a [f32],
    left: &'a mut [f32],
    right: &'a mut [f32],
}

impl Job for Weigh<'_> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        K::weigh::<false>(self.low, self.weight, self.planes, self.left);
        K::weigh::<true>(self.high, self.weight, self.planes, self.right);
    }
}

impl Heuristic for Rdh {
    fn root(&self, bounds: &Aabb) -> NodeRays {
        let whole: Vec<Span> = (0..).zip(&self.lines).map(|(i, line)| line.whole(i)).collect();
        self.descend(&NodeRays { spans: whole }, bounds)
    }

    fn descend(&self, rays: &NodeRays, child: &Aabb) -> NodeRays {
        let mut spans = vec![Span::default(); rays.spans.len()];
        let met = self.clip_all(&rays.spans, child, &mut spans);
        spans.truncate(met);
        // Those of all nodes on the way down are kept.
        spans.shrink_to_fit();
        NodeRays { spans }
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
        let (areas_left, areas_right) = (left.to_vec(), right.to_vec());
        if spans.len() <= FEW {
            self.weigh_few(spans, axis, planes, left, right);
        } else {
            self.weigh_many(spans, axis, planes, left, right);
        }
        let blend = |(p, area): (&mut f32, f32)| *p = mix(weight, *p / total, area);
        left.iter_mut().zip(areas_left).for_each(blend);
        right.iter_mut().zip(areas_right).for_each(blend);
    }
}
