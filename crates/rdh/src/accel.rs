//! One face for all structures.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::batch;
use crate::bvh::{self, Bvh, Shared, Triangles, When, Width};
use crate::error::{Error, Result};
use crate::eye::{Around, EyeTree};
use crate::fault::Fault;
use crate::geom::{Aabb, Hit, Ray, Scale};
use crate::heuristic::{self, HeuristicSpec, Rdh, RdhSpec};
use crate::kd::{KdTree, Prune};
use crate::lazy::Lazy;
use crate::leaf::{Any, Closest};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::parts::{Parts, Written};
use crate::probe::{Counts, Probe};
use crate::rays::{Profile, Training};
use crate::simd::Level;
use crate::spec::{Spec, StructureSpec};
use crate::tile::Batched;

/// A finished structure: answers queries from any number of threads. It holds its own copies of the triangles, and the mesh, whose
/// memory it shares. Clones share all memory.
#[derive(Debug, Clone)]
pub struct Accel {
    structure: Structure,
    mesh: Mesh,
    stats: Stats,
    provenance: Provenance,
}

/// How a structure came about: free notes, which are saved with it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Provenance {
    /// What all randomness of the recording and the choice came from.
    pub seed: Option<u64>,
    /// Scene, view, mode, …: whatever the building program notes; `Null` at first.
    pub settings: Value,
    /// Why this structure and no other.
    pub evidence: Option<Value>,
    /// Rays by which nothing was built or chosen: what it may be judged by, now and later.
    pub unseen: Option<Profile>,
}

/// The closed set of structures: an enum costs nothing here.
#[derive(Debug, Clone)]
pub(crate) enum Structure {
    Kd(KdTree),
    Bvh2(Bvh<2>),
    Bvh4(Bvh<4>),
    Bvh8(Bvh<8>),
    Compact8(Bvh<8, Shared>),
    Lazy(Lazy),
    Eye(Around),
}

/// Does the same with whichever structure it is.
macro_rules! each {
    ($structure:expr, $tree:ident => $work:expr) => {
        match $structure {
            Structure::Kd($tree) => $work,
            Structure::Bvh2($tree) => $work,
            Structure::Bvh4($tree) => $work,
            Structure::Bvh8($tree) => $work,
            Structure::Compact8($tree) => $work,
            Structure::Lazy($tree) => $work,
            Structure::Eye($tree) => $work,
        }
    };
}

/// What was built, for reports.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stats {
    /// What was asked for, in full; what was really built never differs from it. For `auto` this is what it chose, for `kd(eye)` where
    /// the eye is.
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

/// Builds what `spec` names, from `rays` where its heuristic asks for them. It names one structure; `auto` is resolved by
/// [`crate::build()`].
///
/// # Errors
/// A heuristic that needs rays without any, a budget that can't be kept, lack of memory, or cancellation.
pub(crate) fn build(mesh: &Mesh, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Accel> {
    spec.check()?;
    if spec.needs_rays() && rays.is_empty() {
        return Err(Error::NoRays { spec: spec.to_string() });
    }
    let trained_on = if spec.needs_rays() { rays.len() } else { 0 };
    let spec = placed(spec, rays)?;
    let structure = match options.threads {
        None | Some(1) => build_structure(mesh, &spec, rays, options)?,
        // Those who share the work out further do it in this pool.
        Some(threads) => {
            in_pool(threads, || build_structure(mesh, &spec, rays, &BuildOptions { threads: None, ..*options }))?
        }
    };
    Ok(Accel::of(structure, mesh.clone(), spec, trained_on))
}

/// The spec with the eye's place, where rays tell it.
fn placed(spec: &Spec, rays: &Training) -> Result<Spec> {
    match spec.structure {
        StructureSpec::Eye(eye) => Ok(Spec { structure: StructureSpec::Eye(eye.placed(rays)?), ..*spec }),
        _ => Ok(*spec),
    }
}

pub(crate) fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|_| Error::OutOfMemory { what: "threads", bytes: 0 })?.install(work)
}

fn build_structure(mesh: &Mesh, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Structure> {
    // Only rays need it.
    let scale = || {
        let of_mesh = || Scale::of(&mesh.bounds_by(options.threads != Some(1))).factor();
        if spec.needs_rays() { of_mesh() } else { 1.0 }
    };
    match spec.structure {
        StructureSpec::Kd(mut kd) => {
            if kd.prune == Prune::ByHeuristic {
                kd.prune = if spec.heuristic.prunes_by_visits() { Prune::Visits } else { Prune::Area };
            }
            let heuristic = heuristic::from_spec(&spec.heuristic, rays, scale(), options.level());
            Ok(Structure::Kd(KdTree::build(mesh, &kd, heuristic.as_ref(), options)?))
        }
        StructureSpec::Auto => Err(nameless(spec)),
        StructureSpec::Eye(eye) => Ok(Structure::Eye(Around::new(eye.build(mesh, spec.heuristic, rays, options)?))),
        StructureSpec::Bvh(bvh) if bvh.when == When::OnDemand => {
            let rays = match &spec.heuristic {
                HeuristicSpec::Sah => None,
                HeuristicSpec::Rdh(rdh) => Some((rdh, rays)),
            };
            Ok(Structure::Lazy(Lazy::build(mesh, &bvh, rays, options)?))
        }
        StructureSpec::Bvh(bvh) => {
            let guide = match &spec.heuristic {
                HeuristicSpec::Sah => None,
                HeuristicSpec::Rdh(rdh) => {
                    let cap = rdh.cap.or(Some(bvh::RAYS_COUNTED));
                    Some(Rdh::new(&RdhSpec { cap, ..*rdh }, rays, scale()).with_level(options.level()))
                }
            };
            let guide = guide.as_ref();
            Ok(match (bvh.width, bvh.triangles) {
                (Width::Two, Triangles::Copied) => Structure::Bvh2(Bvh::build(mesh, &bvh, guide, options)?),
                (Width::Four, Triangles::Copied) => Structure::Bvh4(Bvh::build(mesh, &bvh, guide, options)?),
                (Width::Eight, Triangles::Copied) => Structure::Bvh8(Bvh::build(mesh, &bvh, guide, options)?),
                (Width::Eight, Triangles::Shared) => Structure::Compact8(Bvh::build(mesh, &bvh, guide, options)?),
                (_, Triangles::Shared) => return Err(unknown_form(spec)),
            })
        }
    }
}

/// Text can't name such a spec, but code can.
pub(crate) fn unknown_form(spec: &Spec) -> Error {
    Error::Spec { spec: spec.to_string(), reason: "shared triangles are for eight children a node".to_owned() }
}

/// For a structure that is never finished, and for one that is soon built anew.
pub(crate) fn unsaved(spec: &Spec) -> Error {
    let reason = match spec.structure {
        StructureSpec::Eye(_) => {
            "trees around a point are not saved: save the structure for all other rays, and build them again"
        }
        _ => "what grows where rays come is not saved: build it again, or save one without 'lazy'",
    };
    Error::Spec { spec: spec.to_string(), reason: reason.to_owned() }
}

/// For a spec that leaves the choice open.
fn nameless(spec: &Spec) -> Error {
    Error::Spec { spec: spec.to_string(), reason: "names no structure".to_owned() }
}

impl Accel {
    /// Of a structure over a mesh.
    pub(crate) fn of(structure: Structure, mesh: Mesh, spec: Spec, trained_on: usize) -> Self {
        let stats = structure.stats(&mesh, &spec, trained_on);
        Self { structure, mesh, stats, provenance: Provenance::default() }
    }

    /// The nearest hit; of equally near ones that with the smallest triangle id.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_probed(ray, &mut ())
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_probed(ray, &mut ())
    }

    /// [`Self::closest`] of each ray, bit for bit, in its place in `hits`: much faster where neighbours in the batch are alike, and
    /// faster where they have nothing to do with each other. Rays of a picture may come row by row, or in tiles. The former holds for kd-trees,
    /// hierarchies of eight children (`bvh8`), and trees around a point and its rays; the latter for such hierarchies. Others cast one by one.
    ///
    /// Works on all threads of rayon's current pool; what comes out does not depend on them.
    ///
    /// # Panics
    /// If there are not as many `hits` as `rays`.
    pub fn closest_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        batch::cast(rays, hits, |ray| self.closest(ray), |rays, hits, width| self.closest_part(rays, hits, width));
    }

    /// [`Self::occluded`] of each ray, as [`Self::closest_many`].
    ///
    /// # Panics
    /// If there are not as many answers as `rays`.
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        batch::cast(
            rays,
            occluded,
            |ray| self.occluded(ray),
            |rays, occluded, width| self.occluded_part(rays, occluded, width),
        );
    }

    /// [`Self::closest_many`] on this thread; `width` is how many rays a row has, if they are whole rows of a picture.
    pub(crate) fn closest_part(&self, rays: &[Ray], hits: &mut [Option<Hit>], width: Option<usize>) {
        match &self.structure {
            Structure::Kd(tree) => _ = tree.part::<Closest>(rays, hits, width),
            Structure::Bvh8(tree) => _ = tree.part::<Closest>(rays, hits, width),
            Structure::Compact8(tree) => _ = tree.part::<Closest>(rays, hits, width),
            Structure::Eye(around) => around.tree().closest_part(rays, hits, width),
            _ => rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.closest(ray)),
        }
    }

    /// [`Self::closest_part`], and what it takes in cycles, about, if that can be said.
    pub(crate) fn closest_effort(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Option<u64> {
        match &self.structure {
            Structure::Kd(tree) => Some(tree.effort::<Closest>(rays, hits)),
            Structure::Bvh8(tree) => Some(tree.effort::<Closest>(rays, hits)),
            Structure::Compact8(tree) => Some(tree.effort::<Closest>(rays, hits)),
            _ => None,
        }
    }

    /// [`Self::occluded_part`], likewise.
    pub(crate) fn occluded_effort(&self, rays: &[Ray], occluded: &mut [bool]) -> Option<u64> {
        match &self.structure {
            Structure::Kd(tree) => Some(tree.effort::<Any>(rays, occluded)),
            Structure::Bvh8(tree) => Some(tree.effort::<Any>(rays, occluded)),
            Structure::Compact8(tree) => Some(tree.effort::<Any>(rays, occluded)),
            _ => None,
        }
    }

    /// [`Self::occluded_many`], likewise.
    pub(crate) fn occluded_part(&self, rays: &[Ray], occluded: &mut [bool], width: Option<usize>) {
        match &self.structure {
            Structure::Kd(tree) => _ = tree.part::<Any>(rays, occluded, width),
            Structure::Bvh8(tree) => _ = tree.part::<Any>(rays, occluded, width),
            Structure::Compact8(tree) => _ = tree.part::<Any>(rays, occluded, width),
            Structure::Eye(around) => around.tree().occluded_part(rays, occluded, width),
            _ => rays.iter().zip(occluded).for_each(|(ray, is)| *is = self.occluded(ray)),
        }
    }

    /// [`Self::closest`], seen by a probe.
    #[inline]
    pub(crate) fn closest_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        each!(&self.structure, tree => tree.closest(ray, probe))
    }

    /// [`Self::occluded`], seen by a probe.
    #[inline]
    pub(crate) fn occluded_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        each!(&self.structure, tree => tree.occluded(ray, probe))
    }

    /// [`Self::all_hits`], seen by a probe.
    #[inline]
    pub(crate) fn all_hits_probed<P: Probe>(&self, ray: &Ray, probe: &mut P, hits: &mut Vec<Hit>) {
        each!(&self.structure, tree => tree.all_hits(ray, probe, hits));
    }

    /// All hits, nearest first, then by id; each shared edge counts for exactly one of its triangles.
    /// `hits` is cleared first; passing the same vector again saves allocations.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        self.all_hits_probed(ray, &mut (), hits);
    }

    /// The nearest hit that `passes`: for cut-outs, and for what a ray must not see. It is asked about hits in any order, about
    /// some that lie behind the result, and about one triangle perhaps several times; it must always answer alike.
    ///
    /// What does not pass is no hit: record what this returns.
    pub fn closest_where(&self, ray: &Ray, mut passes: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        each!(&self.structure, tree => tree.closest_where(ray, &mut passes))
    }

    /// Whether anything that `passes` is hit; it is asked as in [`Self::closest_where`].
    pub fn occluded_where(&self, ray: &Ray, mut passes: impl FnMut(&Hit) -> bool) -> bool {
        each!(&self.structure, tree => tree.occluded_where(ray, &mut passes))
    }

    /// [`Self::closest`], and what it cost, added to `counts`.
    pub fn closest_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        self.closest_probed(ray, counts)
    }

    /// [`Self::occluded`], and what it cost, added to `counts`.
    pub fn occluded_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        self.occluded_probed(ray, counts)
    }

    /// [`Self::all_hits`], and what it cost, added to `counts`.
    pub fn all_hits_counted(&self, ray: &Ray, hits: &mut Vec<Hit>, counts: &mut Counts) {
        self.all_hits_probed(ray, counts, hits);
    }

    /// What was built; of a lazy structure, what had been when the build ended ([`Lazy::growth`] says how it is now).
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// The mesh that it was built over.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// How it came about.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// The same structure with notes of how it came about.
    pub fn with_provenance(self, provenance: Provenance) -> Self {
        Self { provenance, ..self }
    }

    /// What it is made of.
    pub(crate) fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        each!(&self.structure, tree => tree.bounds())
    }

    /// Visits the structure's leaf cells: box, depth, triangles. Trees around a point have cells of a picture; those of the structure for
    /// all other rays are shown instead.
    pub fn cells(&self, visit: &mut dyn FnMut(Aabb, usize, usize)) {
        self.cells_with_ids(&mut |cell, depth, ids| visit(cell, depth, ids.len()));
    }

    pub(crate) fn cells_with_ids(&self, visit: &mut dyn FnMut(Aabb, usize, &[u32])) {
        each!(&self.structure, tree => tree.cells(visit));
    }

    /// The trees around an eye, if it has such: for those who look at their size, or want the structure for all other rays.
    pub fn eye_tree(&self) -> Option<&EyeTree> {
        match &self.structure {
            Structure::Eye(around) => Some(around.tree()),
            _ => None,
        }
    }

    /// The kd-tree, if it is one: for those who study its nodes.
    pub fn kd_tree(&self) -> Option<&KdTree> {
        match &self.structure {
            Structure::Kd(tree) => Some(tree),
            _ => None,
        }
    }

    /// The lazy structure, if it is one: to see how it grows.
    pub fn lazy(&self) -> Option<&Lazy> {
        match &self.structure {
            Structure::Lazy(tree) => Some(tree),
            _ => None,
        }
    }

    /// All faults of the structure over its mesh; none if it is well-formed.
    pub fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        each!(&self.structure, tree => tree.check(mesh))
    }

    /// The same structure, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        let structure = match self.structure {
            Structure::Kd(tree) => Structure::Kd(tree.with_level(level)),
            Structure::Bvh2(tree) => Structure::Bvh2(tree.with_level(level)),
            Structure::Bvh4(tree) => Structure::Bvh4(tree.with_level(level)),
            Structure::Bvh8(tree) => Structure::Bvh8(tree.with_level(level)),
            Structure::Compact8(tree) => Structure::Compact8(tree.with_level(level)),
            Structure::Lazy(tree) => Structure::Lazy(tree.with_level(level)),
            Structure::Eye(around) => Structure::Eye(around.with_level(level)),
        };
        Self { structure, ..self }
    }

    /// The structure's arrays as bytes: equal for equal structures.
    pub fn fingerprint(&self) -> u64 {
        each!(&self.structure, tree => tree.fingerprint())
    }
}

impl Structure {
    /// Its arrays, to be saved.
    pub(crate) fn parts(&self) -> Vec<Written<'_>> {
        match self {
            // They are refused before.
            Self::Lazy(_) | Self::Eye(_) => Vec::new(),
            Self::Kd(tree) => tree.parts(),
            Self::Bvh2(tree) => tree.parts(),
            Self::Bvh4(tree) => tree.parts(),
            Self::Bvh8(tree) => tree.parts(),
            Self::Compact8(tree) => tree.parts(),
        }
    }

    /// The structure of this kind that saved arrays make, checked.
    pub(crate) fn from_parts(spec: &Spec, parts: &Parts<'_>, mesh: &Mesh) -> Result<Self> {
        Ok(match spec.structure {
            StructureSpec::Auto => return Err(nameless(spec)),
            StructureSpec::Eye(_) => return Err(unsaved(spec)),
            StructureSpec::Bvh(bvh) if bvh.when == When::OnDemand => return Err(unsaved(spec)),
            StructureSpec::Kd(_) => Self::Kd(KdTree::from_parts(parts, mesh)?),
            StructureSpec::Bvh(bvh) => match (bvh.width, bvh.triangles) {
                (Width::Two, Triangles::Copied) => Self::Bvh2(Bvh::from_parts(parts, mesh)?),
                (Width::Four, Triangles::Copied) => Self::Bvh4(Bvh::from_parts(parts, mesh)?),
                (Width::Eight, Triangles::Copied) => Self::Bvh8(Bvh::from_parts(parts, mesh)?),
                (Width::Eight, Triangles::Shared) => Self::Compact8(Bvh::from_parts(parts, mesh)?),
                (_, Triangles::Shared) => return Err(unknown_form(spec)),
            },
        })
    }

    fn stats(&self, mesh: &Mesh, spec: &Spec, trained_on: usize) -> Stats {
        let (nodes, leaves, empty_leaves, references, depth) = match self {
            Self::Kd(tree) => {
                let t = tree.tally();
                (2 * t.leaves - 1, t.leaves, t.empty_leaves, t.references, t.depth)
            }
            Self::Bvh2(tree) => bvh_stats(tree.tally()),
            Self::Bvh4(tree) => bvh_stats(tree.tally()),
            Self::Bvh8(tree) => bvh_stats(tree.tally()),
            Self::Compact8(tree) => bvh_stats(tree.tally()),
            Self::Lazy(tree) => lazy_stats(tree.growth()),
            Self::Eye(around) => around.shape(),
        };
        let bytes = each!(self, tree => tree.bytes());
        Stats { spec: *spec, triangles: mesh.len(), nodes, leaves, empty_leaves, references, depth, bytes, trained_on }
    }
}

fn lazy_stats(g: crate::lazy::Growth) -> (usize, usize, usize, usize, usize) {
    let leaves = g.tree_leaves + g.waiting + g.bare;
    let references = g.tree_triangles + g.waiting_triangles + g.bare_triangles;
    (g.upper_nodes + g.tree_nodes + leaves, leaves, 0, references, g.depth)
}

fn bvh_stats(t: crate::bvh::Tally) -> (usize, usize, usize, usize, usize) {
    (t.interiors + t.leaves, t.leaves, 0, t.references, t.depth)
}
