//! Rays through the hierarchy over a mesh's image: boxes are met as ever, triangles are tested in f64.

use super::coarse::Image;
use super::mesh::MeshF64;
use super::ray::{HitF64, RayF64};
use super::triangle::{Frame, Sheared};
use crate::bvh::trace::Caster;
use crate::bvh::{Bvh, Leaves};
use crate::geom::TriId;
use crate::simd::{Block, Boxes, Entered, Job, Kernels, LANES};

/// Takes a hit; returns the largest `t` that is still of interest, or nothing if the ray is done.
pub(super) type Sink<'a> = &'a mut dyn FnMut(&HitF64, &Sheared) -> Option<f64>;

/// What is asked.
pub(super) struct Query<'a> {
    pub(super) mesh: &'a MeshF64,
    pub(super) ray: &'a RayF64,
    pub(super) image: &'a Image,
    pub(super) sink: Sink<'a>,
}

/// One ray's way through a tree.
pub(super) struct Walk<'a, L, const W: usize> {
    pub(super) tree: &'a Bvh<W, L>,
    pub(super) query: Query<'a>,
}

impl<L: Leaves, const W: usize> Job for Walk<'_, L, W> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        let Self { tree, query } = self;
        if let Some(boxes) = tree.box_ray::<K>(&query.image.ray) {
            let frame = Frame::new(query.ray, query.mesh);
            tree.lead::<K, _, _>(&mut Decider::<K> { boxes, frame, query }, &mut ());
        }
    }
}

/// A ray that is being cast, whose hits are decided in f64.
struct Decider<'a, K: Kernels> {
    boxes: K::BoxRay,
    frame: Frame,
    query: Query<'a>,
}

impl<K: Kernels, const W: usize> Caster<W> for Decider<'_, K> {
    const ANY: bool = false;

    #[inline(always)]
    fn meet(&self, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32 {
        K::meet(&self.boxes, boxes, t)
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        K::end(&self.boxes)
    }

    #[inline(always)]
    fn test(&mut self, block: &Block, wanted: u32) -> bool {
        match self.query.decide(&self.frame, &block.ids, wanted) {
            // Without an end it goes on as it did.
            Some(Some(end)) if end.is_finite() => K::end_at(&mut self.boxes, end),
            Some(_) => {}
            None => return false,
        }
        true
    }
}

impl Query<'_> {
    /// Tests triangles: the image's new end if there were hits, or nothing if the ray is done. Never inlined, so that there is one copy
    /// for all trees and instructions.
    #[inline(never)]
    fn decide(&mut self, frame: &Frame, ids: &[u32; LANES], wanted: u32) -> Option<Option<f32>> {
        let mut end = None;
        for (_, &id) in ids.iter().enumerate().filter(|(lane, _)| wanted >> lane & 1 == 1) {
            let tri = TriId(id);
            if !self.mesh.is_seen(tri, self.ray.mask) {
                continue;
            }
            if let Some((hit, sheared)) = frame.hit(&self.mesh.corners(tri), tri) {
                end = Some(self.image.behind((self.sink)(&hit, &sheared)?));
            }
        }
        Some(end)
    }
}
