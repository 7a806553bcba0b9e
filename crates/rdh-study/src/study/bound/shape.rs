//! What boxes are filled with: the parts of triangles, cut exactly, and the parts of rays.

use rdh::{Mesh, Ray, Training, TriId};

/// The part of a triangle that lies in a box.
#[derive(Clone, Debug)]
pub struct Part {
    corners: Vec<[f64; 3]>,
    /// The lower corner of its own box.
    pub low: [f64; 3],
    /// The upper corner of its own box.
    pub high: [f64; 3],
}

impl Part {
    /// All of a mesh's triangles, whole.
    pub fn all(mesh: &Mesh) -> Vec<Self> {
        let corners = |i: usize| mesh.corners(TriId(i as u32)).map(|p| p.map(f64::from)).to_vec();
        (0..mesh.len()).map(|i| Self::new(corners(i))).collect()
    }

    fn new(corners: Vec<[f64; 3]>) -> Self {
        let along = |axis: usize| corners.iter().map(move |p| p[axis]);
        let low = [0, 1, 2].map(|axis| along(axis).fold(f64::INFINITY, f64::min));
        let high = [0, 1, 2].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
        Self { corners, low, high }
    }

    /// The parts below and above a plane. What only touches the plane stays whole on its side; what lies flat in it goes
    /// below or above as a whole.
    pub fn split(&self, axis: usize, plane: f64, flat_below: bool) -> [Option<Self>; 2] {
        let flat = self.low[axis] == plane && self.high[axis] == plane;
        let below = self.low[axis] < plane || (flat && flat_below);
        let above = self.high[axis] > plane || (flat && !flat_below);
        match (below, above) {
            (true, true) => [self.cut(axis, plane, 1.0), self.cut(axis, plane, -1.0)],
            (below, above) => [below.then(|| self.clone()), above.then(|| self.clone())],
        }
    }

    /// Sutherland and Hodgman 1974: the corners on one side, and the points where edges cross the plane.
    fn cut(&self, axis: usize, plane: f64, sign: f64) -> Option<Self> {
        let n = self.corners.len();
        let mut corners = Vec::with_capacity(n + 1);
        for i in 0..n {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % n]);
            let (dp, dq) = (sign * (plane - p[axis]), sign * (plane - q[axis]));
            if dp >= 0.0 {
                corners.push(p);
            }
            if dp * dq < 0.0 {
                let s = dp / (dp - dq);
                let mut cut = [0, 1, 2].map(|a| p[a] + s * (q[a] - p[a]));
                cut[axis] = plane;
                corners.push(cut);
            }
        }
        (!corners.is_empty()).then(|| Self::new(corners))
    }
}

/// The part of a ray that lies in a box: closed, so that what runs in a face is in both boxes.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    origin: [f64; 3],
    direction: [f64; 3],
    start: f64,
    end: f64,
}

impl Segment {
    /// The rays of a profile as far as their queries looked. Invalid rays look nowhere.
    pub fn all(rays: &Training) -> Vec<Self> {
        let valid = rays.samples().iter().filter(|s| s.ray.is_valid());
        valid.map(|s| Self::new(&s.ray, s.t_end())).collect()
    }

    /// The same rays as far as they may go, as if nothing stopped them.
    pub fn all_whole(rays: &Training) -> Vec<Self> {
        let valid = rays.samples().iter().filter(|s| s.ray.is_valid());
        valid.map(|s| Self::new(&s.ray, f32::INFINITY)).collect()
    }

    /// A ray up to some `t`.
    pub fn new(ray: &Ray, end: f32) -> Self {
        let wide = |v: [f32; 3]| v.map(f64::from);
        let (origin, direction) = (wide(ray.origin), wide(ray.direction));
        Self { origin, direction, start: ray.t_min.into(), end: end.into() }
    }

    /// The part between two planes, if there is any.
    pub fn clip(mut self, axis: usize, low: f64, high: f64) -> Option<Self> {
        let (o, d) = (self.origin[axis], self.direction[axis]);
        if d == 0.0 {
            return (low <= o && o <= high).then_some(self);
        }
        let (a, b) = ((low - o) / d, (high - o) / d);
        self.start = self.start.max(a.min(b));
        self.end = self.end.min(a.max(b));
        (self.start <= self.end).then_some(self)
    }

    /// Its lowest and highest point along an axis.
    pub fn extent(&self, axis: usize) -> (f64, f64) {
        let at = |t: f64| {
            if self.direction[axis] == 0.0 { self.origin[axis] } else { self.origin[axis] + t * self.direction[axis] }
        };
        let (a, b) = (at(self.start), at(self.end));
        (a.min(b), a.max(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_cut_and_flat_ones_go_where_they_are_sent() {
        let part = Part::new(vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
        let [below, above] = part.split(0, 1.0, true).map(Option::unwrap);
        assert_eq!((below.low, below.high), ([0.0, 0.0, 0.0], [1.0, 2.0, 0.0]));
        assert_eq!((above.low, above.high), ([1.0, 0.0, 0.0], [2.0, 1.0, 0.0]));
        assert!(part.split(0, 2.0, true)[1].is_none(), "a touching corner is not above");
        for flat_below in [true, false] {
            let sides = part.split(2, 0.0, flat_below).map(|p| p.is_some());
            assert_eq!(sides, [flat_below, !flat_below]);
        }
    }

    #[test]
    fn segments_end_at_planes() {
        let ray = Ray::new([0.0, 0.5, 0.0], [2.0, 0.0, 0.0]);
        let whole = Segment::new(&ray, f32::INFINITY);
        let part = whole.clip(0, 1.0, 3.0).unwrap();
        assert_eq!((part.extent(0), part.extent(1)), ((1.0, 3.0), (0.5, 0.5)));
        assert!(whole.clip(1, 0.6, 1.0).is_none() && whole.clip(1, 0.5, 1.0).is_some());
        assert!(Segment::new(&ray, 1.0).clip(0, 2.5, 3.0).is_none(), "it has ended before");
    }
}
