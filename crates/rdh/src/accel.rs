//! One face for all structures.

use crate::error::{Error, Result};
use crate::geom::{Aabb, Hit, Ray};
use crate::heuristic;
use crate::kd::{Fault, KdTree, Prune};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::probe::Counts;
use crate::rays::Training;
use crate::simd::Level;
use crate::spec::{Spec, StructureSpec};

/// A finished structure: answers queries from any number of threads. It holds its own copies of the triangles.
#[derive(Debug, Clone)]
pub struct Accel {
    structure: Structure,
    stats: Stats,
}

/// The closed set of structures: an enum costs nothing here.
#[derive(Debug, Clone)]
enum Structure {
    Kd(KdTree),
}

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

/// Builds what `spec` names, from `rays` where its heuristic asks for them.
///
/// # Errors
/// A heuristic that needs rays without any, a budget that can't be kept, lack of memory, or cancellation.
pub fn build(mesh: &Mesh, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Accel> {
    if spec.needs_rays() && rays.is_empty() {
        return Err(Error::NoRays { spec: spec.to_string() });
    }
    let structure = match options.threads {
        None | Some(1) => build_structure(mesh, spec, rays, options)?,
        Some(threads) => in_pool(threads, || build_structure(mesh, spec, rays, options))?,
    };
    let trained_on = if spec.needs_rays() { rays.len() } else { 0 };
    let stats = structure.stats(mesh, spec, trained_on);
    Ok(Accel { structure, stats })
}

fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|_| Error::OutOfMemory { what: "threads", bytes: 0 })?.install(work)
}

fn build_structure(mesh: &Mesh, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Structure> {
    let scale = crate::geom::Scale::of(&mesh.bounds()).factor();
    let heuristic = heuristic::from_spec(&spec.heuristic, rays, scale);
    let StructureSpec::Kd(mut kd) = spec.structure;
    if kd.prune == Prune::ByHeuristic {
        kd.prune = if spec.heuristic.prunes_by_visits() { Prune::Visits } else { Prune::Area };
    }
    Ok(Structure::Kd(KdTree::build(mesh, &kd, heuristic.as_ref(), options)?))
}

impl Accel {
    /// The nearest hit; of equally near ones that with the smallest triangle id.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let Structure::Kd(tree) = &self.structure;
        tree.closest(ray, &mut ())
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let Structure::Kd(tree) = &self.structure;
        tree.occluded(ray, &mut ())
    }

    /// All hits, nearest first, then by id; each shared edge counts for exactly one of its triangles.
    /// `hits` is cleared first; passing the same vector again saves allocations.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        let Structure::Kd(tree) = &self.structure;
        tree.all_hits(ray, &mut (), hits);
    }

    /// [`Self::closest`], and what it cost, added to `counts`.
    pub fn closest_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        let Structure::Kd(tree) = &self.structure;
        tree.closest(ray, counts)
    }

    /// [`Self::occluded`], and what it cost, added to `counts`.
    pub fn occluded_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        let Structure::Kd(tree) = &self.structure;
        tree.occluded(ray, counts)
    }

    /// What was built.
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        let Structure::Kd(tree) = &self.structure;
        tree.bounds()
    }

    /// Visits the structure's leaf cells: box, depth, triangles.
    pub fn cells(&self, visit: &mut dyn FnMut(Aabb, usize, usize)) {
        let Structure::Kd(tree) = &self.structure;
        tree.cells(&mut |cell, depth, ids| visit(cell, depth, ids.len()));
    }

    /// All faults of the structure over its mesh; none if it is well-formed.
    pub fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        let Structure::Kd(tree) = &self.structure;
        tree.check(mesh)
    }

    /// The same structure, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        let Structure::Kd(tree) = self.structure;
        Self { structure: Structure::Kd(tree.with_level(level)), stats: self.stats }
    }

    /// The structure's arrays as bytes: equal for equal structures.
    pub fn fingerprint(&self) -> u64 {
        let Structure::Kd(tree) = &self.structure;
        tree.fingerprint()
    }
}

impl Structure {
    fn stats(&self, mesh: &Mesh, spec: &Spec, trained_on: usize) -> Stats {
        let Self::Kd(tree) = self;
        let tally = tree.tally();
        Stats {
            spec: *spec,
            triangles: mesh.len(),
            nodes: 2 * tally.leaves - 1,
            leaves: tally.leaves,
            empty_leaves: tally.empty_leaves,
            references: tally.references,
            depth: tally.depth,
            bytes: tree.bytes(),
            trained_on,
        }
    }
}
