//! One ray through the trees: the leaf of its place in the picture, front to back.

use super::EyeTree;
use super::face::Face;
use super::side::Side;
use super::spec::EyeForm;
use crate::geom::{Hit, Ray, RayFrame, TriId, hit_triangle};
use crate::probe::Probe;
use crate::simd::{Aims, Approach, Corners, Sight, step_of};

impl EyeTree {
    /// The nearest hit; of equally near ones that with the smallest id.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_probed(ray, &mut ())
    }

    /// Whether anything is hit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_probed(ray, &mut ())
    }

    pub(crate) fn closest_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        match self.own(ray) {
            Some((face, frame)) => self.closest_in(face, &frame, ray, probe),
            None => self.world.closest_probed(ray, probe),
        }
    }

    pub(crate) fn occluded_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        if let Some((face, frame)) = self.own(ray) {
            return self.closest_in(face, &frame, ray, probe).is_some();
        }
        match self.approaching(ray) {
            Some((face, frame, approach)) => self.occluded_in(face, &frame, &approach, ray, probe),
            None => self.world.occluded_probed(ray, probe),
        }
    }

    /// The face and the frame of a ray that starts at the eye.
    fn own(&self, ray: &Ray) -> Option<(&Face, RayFrame)> {
        if !self.starts_at_eye(ray) || !ray.is_valid() || ray.t_min < 0.0 {
            return None;
        }
        let frame = RayFrame::new(ray);
        let usual = (Aims::SHORTEST..=Aims::LONGEST).contains(&frame.direction_z.abs());
        let face = self.faces[Side::of(&frame).index()].as_ref()?;
        let [u, v] = frame.shear;
        (usual && face.window.has(u, v)).then_some((face, frame))
    }

    /// The face, the frame and the part of a ray that ends at the eye.
    pub(super) fn approaching(&self, ray: &Ray) -> Option<(&Face, RayFrame, Approach)> {
        if self.form != EyeForm::Towards || !ray.is_valid() {
            return None;
        }
        let frame = RayFrame::new(ray);
        let face = self.faces[Side::of(&frame).opposite().index()].as_ref()?;
        let [u, v] = frame.shear;
        if !face.window.has(u, v) {
            return None;
        }
        Some((face, frame, self.passing.approach(&frame)?))
    }

    /// The nearest hit of a ray from the eye.
    pub(super) fn closest_in<P: Probe>(&self, face: &Face, frame: &RayFrame, ray: &Ray, probe: &mut P) -> Option<Hit> {
        // What is hidden is not there: a ray that starts behind what hides it finds out by hitting that.
        let from_eye = RayFrame { t_min: if self.drops_hidden() { 0.0 } else { ray.t_min }, ..as_given(frame) };
        let [u, v] = frame.shear;
        let (column, row) = (step_of(u), step_of(v));
        let mut best: Option<Hit> = None;
        // What is less near can't win.
        let (mut least, mut looked) = (f32::NEG_INFINITY, 0);
        for entry in face.leaf_at(u, v, probe) {
            if entry.near < least {
                break;
            }
            looked += 1;
            let beside =
                (entry.low[0] > column) | (entry.high[0] < column) | (entry.low[1] > row) | (entry.high[1] < row);
            let sight = &face.sights[entry.sight as usize];
            if beside || !may_hit(sight, u, v, least) || !self.sees(sight.id, ray) {
                continue;
            }
            let corners = &face.corners[entry.sight as usize];
            let Some(hit) = hit_triangle(&from_eye, &points(corners), TriId(sight.id)) else { continue };
            if best.is_none_or(|best| hit.wins_over(&best)) {
                best = Some(hit);
                least = nearness(&hit, frame);
            }
        }
        probe.leaf(looked);
        match best {
            Some(hit) if hit.t < ray.t_min => self.world.closest_probed(ray, probe),
            _ => best,
        }
    }

    /// Whether a ray that ends at the eye is stopped before.
    fn occluded_in<P: Probe>(
        &self,
        face: &Face,
        frame: &RayFrame,
        approach: &Approach,
        ray: &Ray,
        probe: &mut P,
    ) -> bool {
        let [u, v] = frame.shear;
        let (mut beyond_end, mut looked) = (false, 0);
        for entry in face.leaf_at(u, v, probe) {
            if entry.near < approach.far {
                break;
            }
            looked += 1;
            let sight = &face.sights[entry.sight as usize];
            if !may_hit(sight, u, v, approach.far) {
                continue;
            }
            if self.stops(face, entry.sight, frame, ray) {
                probe.leaf(looked);
                return true;
            }
            beyond_end |= sight.span(u, v).1 >= approach.near_surely;
        }
        probe.leaf(looked);
        // What lies between the end and the eye may have hidden what lies before the end.
        beyond_end && self.drops_hidden() && self.world.occluded_probed(ray, probe)
    }

    /// Whether THE triangle test finds a hit of a triangle that the ray sees.
    pub(super) fn stops(&self, face: &Face, index: u32, frame: &RayFrame, ray: &Ray) -> bool {
        let (id, corners) = (face.sights[index as usize].id, &face.corners[index as usize]);
        self.sees(id, ray) && hit_triangle(&as_given(frame), &points(corners), TriId(id)).is_some()
    }

    /// Whether a ray sees a triangle, by its mask.
    #[inline(always)]
    pub(super) fn sees(&self, id: u32, ray: &Ray) -> bool {
        self.masks.as_ref().is_none_or(|masks| masks[id as usize] & ray.mask != 0)
    }

    /// Whether leaves lack what nobody sees from the eye. With masks there is no telling.
    pub(super) fn drops_hidden(&self) -> bool {
        self.masks.is_none()
    }
}

/// Whether a ray may hit a triangle, and at least so near.
#[inline(always)]
fn may_hit(sight: &Sight, u: f32, v: f32, least: f32) -> bool {
    sight.inside(u, v) >= -1.0 && sight.span(u, v).1 >= least
}

/// The frame for corners that are given along its axes.
#[inline(always)]
fn as_given(frame: &RayFrame) -> RayFrame {
    RayFrame { k: [0, 1, 2], ..*frame }
}

/// Three corners.
#[inline(always)]
fn points(corners: &Corners) -> [[f32; 3]; 3] {
    corners.map(|[x, y, z, _]| [x, y, z])
}

/// What is less near than this is farther than the hit; also where `t` is 0 by rounding.
fn nearness(hit: &Hit, frame: &RayFrame) -> f32 {
    const LESS: f32 = 1.0 - 1e-5;
    (LESS / (hit.t * frame.direction_z.abs())).min(1e30)
}
