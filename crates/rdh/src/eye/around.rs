//! Trees around an eye as one structure among others: what they don't know, the structure for all other rays does.

use std::sync::Arc;

use super::{EyeTree, Face};
use crate::accel::{Accel, Structure};
use crate::fault::Fault;
use crate::geom::{Aabb, Hit, Ray};
use crate::mesh::Mesh;
use crate::probe::Probe;
use crate::simd::Level;

/// Shared, since trees around an eye hold a structure themselves.
#[derive(Debug, Clone)]
pub(crate) struct Around(Arc<EyeTree>);

impl From<EyeTree> for Accel {
    /// With all that structures can do. What is [saved](Accel::to_bytes) is the [world](EyeTree::world) alone, by itself.
    fn from(tree: EyeTree) -> Self {
        let (mesh, spec, trained_on) = (tree.world.mesh().clone(), tree.spec(), tree.trained_on);
        Self::of(Structure::Eye(Around::new(tree)), mesh, spec, trained_on)
    }
}

impl Around {
    pub(crate) fn new(tree: EyeTree) -> Self {
        Self(Arc::new(tree))
    }

    pub(crate) fn tree(&self) -> &EyeTree {
        &self.0
    }

    #[inline(never)]
    pub(crate) fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.0.closest_probed(ray, probe)
    }

    #[inline(never)]
    pub(crate) fn occluded<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.0.occluded_probed(ray, probe)
    }

    pub(crate) fn all_hits<P: Probe>(&self, ray: &Ray, probe: &mut P, hits: &mut Vec<Hit>) {
        self.0.world.all_hits_probed(ray, probe, hits);
    }

    pub(crate) fn closest_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> Option<Hit> {
        self.0.world.closest_where(ray, passes)
    }

    pub(crate) fn occluded_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> bool {
        self.0.world.occluded_where(ray, passes)
    }

    pub(crate) fn bounds(&self) -> Aabb {
        self.0.world.bounds()
    }

    /// The cells of space; those of pictures are none.
    pub(crate) fn cells(&self, visit: &mut dyn FnMut(Aabb, usize, &[u32])) {
        self.0.world.cells_with_ids(visit);
    }

    pub(crate) fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        self.0.check_over(mesh)
    }

    pub(crate) fn bytes(&self) -> usize {
        self.0.bytes() + self.0.world.stats().bytes
    }

    pub(crate) fn fingerprint(&self) -> u64 {
        self.0.fingerprint() ^ self.0.world.fingerprint().rotate_left(1)
    }

    pub(crate) fn with_level(self, level: Level) -> Self {
        Self::new(Arc::unwrap_or_clone(self.0).with_level(level))
    }

    /// Nodes, leaves, empty ones, references and depth of all trees together.
    pub(crate) fn shape(&self) -> (usize, usize, usize, usize, usize) {
        let world = self.0.world.stats();
        let start = (world.nodes, world.leaves, world.empty_leaves, world.references, world.depth);
        self.0.faces.iter().flatten().fold(start, |(nodes, leaves, empty, references, depth), face| {
            let (own_empty, own_depth) = Face::shape(face);
            let pairs = face.pairs.len();
            let counts = (nodes + 2 * pairs + 1, leaves + pairs + 1, empty + own_empty);
            (counts.0, counts.1, counts.2, references + face.entries.len(), depth.max(own_depth))
        })
    }
}
