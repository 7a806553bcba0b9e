//! Brute force in f64: the oracle. Slow on purpose.

use super::mesh::MeshF64;
use super::ray::{HitF64, RayF64};
use super::triangle::{Frame, Sheared, owns};
use crate::geom::TriId;

/// The nearest hit; of equally near ones that with the smallest id. O(n).
pub fn closest(mesh: &MeshF64, ray: &RayF64) -> Option<HitF64> {
    hits(mesh, ray).map(|(hit, _)| hit).reduce(|best, hit| if hit.wins_over(&best) { hit } else { best })
}

/// Whether anything is hit. O(n).
pub fn occluded(mesh: &MeshF64, ray: &RayF64) -> bool {
    hits(mesh, ray).next().is_some()
}

/// All hits, nearest first, then by id; each shared edge counts for exactly one of its triangles. O(n log n).
pub fn all_hits(mesh: &MeshF64, ray: &RayF64) -> Vec<HitF64> {
    let mut all: Vec<HitF64> = hits(mesh, ray).filter(|(_, sheared)| owns(sheared)).map(|(hit, _)| hit).collect();
    all.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.tri.cmp(&b.tri)));
    all
}

fn hits(mesh: &MeshF64, ray: &RayF64) -> impl Iterator<Item = (HitF64, Sheared)> {
    let (frame, mask) = (ray.is_valid().then(|| Frame::new(ray, mesh)), ray.mask);
    let ids = 0..if frame.is_some() { mesh.len() as u32 } else { 0 };
    ids.map(TriId)
        .filter(move |&tri| mesh.is_seen(tri, mask))
        .filter_map(move |tri| frame?.hit(&mesh.corners(tri), tri))
}
