//! Brute force: the oracle that everything fast must agree with. Slow on purpose.

use crate::geom::{Hit, Ray, RayFrame, TriId, hit_triangle, owns_crossing};
use crate::mesh::Mesh;

/// The nearest hit; of equally near ones that with the smallest id. O(n).
pub fn closest(mesh: &Mesh, ray: &Ray) -> Option<Hit> {
    hits(mesh, ray).reduce(|best, hit| if hit.wins_over(&best) { hit } else { best })
}

/// Whether anything is hit. O(n).
pub fn occluded(mesh: &Mesh, ray: &Ray) -> bool {
    hits(mesh, ray).next().is_some()
}

/// All hits, nearest first, then by id; each shared edge counts for exactly one of its triangles. O(n log n).
pub fn all_hits(mesh: &Mesh, ray: &Ray) -> Vec<Hit> {
    let owned = |hit: &Hit| owns_crossing(&RayFrame::new(ray), &mesh.corners(hit.tri));
    let mut all: Vec<Hit> = hits(mesh, ray).filter(owned).collect();
    all.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.tri.cmp(&b.tri)));
    all
}

fn hits(mesh: &Mesh, ray: &Ray) -> impl Iterator<Item = Hit> {
    let frame = ray.is_valid().then(|| RayFrame::new(ray));
    let visible = |i: u32| mesh.masks().is_none_or(|m| m[i as usize] & ray.mask != 0);
    let ids = 0..if frame.is_some() { mesh.len() as u32 } else { 0 };
    ids.filter(move |&i| visible(i)).filter_map(move |i| {
        let tri = TriId(i);
        hit_triangle(&frame?, &mesh.corners(tri), tri)
    })
}
