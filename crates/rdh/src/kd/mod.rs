//! The kd-tree: an exact and a binned builder, pruning, 8-byte nodes, leaves of 8-wide blocks.
//!
//! `build` grows branches from references (`reference`), candidate planes (`events`, `split`), costs and a stop rule;
//! `layout` packs them; `trace` walks them, `tile` with many rays at once; `check` proves them.

mod bins;
pub(crate) mod branch;
mod build;
mod check;
mod cost;
mod events;
mod few;
mod layout;
mod node;
mod reference;
mod shown;
mod spec;
mod split;
pub(crate) mod stop;
mod tile;
mod trace;

pub use cost::Costs;
pub use layout::Tally;
pub use node::{Node, NodeKind};
pub use reference::Reference;
pub use shown::Shown;
pub use spec::{KdSpec, LeafWidth, Prune, SplitSearch, Stop};

use branch::{Branches, Kept};
use build::Builder;
use layout::{Arrays, Draft, Line};

use crate::clip::TriangleClipper;
use crate::error::{Error, Result};
use crate::geom::{Aabb, Hit, Ray, Scale, TriId};
use crate::heuristic::Heuristic;
use crate::leaf::{self, Collector};
use crate::mem::Array;
use crate::mesh::Mesh;
use crate::options::{BuildOptions, Watch};
use crate::parts::{Part, Parts, Place, Written};
use crate::probe::{Counts, Probe};
use crate::simd::{Block, InPlace, Level};
use crate::tile::{Batched, Cost, Packed};

/// A finished kd-tree, with its own copies of the triangles. Plain arrays without pointers.
#[derive(Debug, Clone)]
pub struct KdTree {
    scale: Scale,
    /// In scaled space, like all planes.
    bounds: Aabb,
    magnitude: f32,
    root: Node,
    lines: Array<Line>,
    blocks: Array<Block>,
    masks: Option<Array<u32>>,
    tally: Tally,
    level: Level,
}

/// Bytes a reference costs at most: its lanes, were every leaf of five alone in its block, and its share of nodes.
const BYTES_PER_REFERENCE: usize = 96;

impl KdTree {
    /// Builds a tree over a mesh: O(N log N); with R rays another O(R log R) a level.
    ///
    /// # Errors
    /// [`Error::OverBudget`], [`Error::OutOfMemory`] or [`Error::Cancelled`].
    pub fn build(mesh: &Mesh, spec: &KdSpec, heuristic: &dyn Heuristic, options: &BuildOptions<'_>) -> Result<Self> {
        let parallel = options.threads != Some(1);
        let in_mesh = mesh.bounds_by(parallel);
        let scale = Scale::of(&in_mesh);
        let clipper = TriangleClipper { mesh, scale: scale.factor() };
        let bounds = scale.scaled(&in_mesh);
        let branches = grow(&clipper, bounds, spec, heuristic, max_refs(mesh.len(), options)?, options)?;
        let root = branches.nodes.len() as u32 - 1;
        let (corners, watch) = (|id| mesh.corners(TriId(id)), &Watch::new(options, mesh.len()));
        let arrays = Draft { branches: &branches, corners, parallel, watch }.lay_out(root)?;
        let Arrays { root, lines, blocks, tally } = arrays;
        let tree = Self {
            root,
            tally,
            level: options.level(),
            ..Self::of_arrays(&in_mesh, lines.into(), blocks.into(), mesh.mask_array())
        };
        match options.max_bytes {
            Some(limit) if tree.bytes() > limit => Err(Error::OverBudget { what: "bytes", limit }),
            _ => Ok(tree),
        }
    }

    /// Without a root yet.
    fn of_arrays(in_mesh: &Aabb, lines: Array<Line>, blocks: Array<Block>, masks: Option<Array<u32>>) -> Self {
        let scale = Scale::of(in_mesh);
        let bounds = scale.scaled(in_mesh);
        let (magnitude, root, tally) = (bounds.magnitude(), Node::default(), Tally::default());
        Self { scale, bounds, magnitude, root, lines, blocks, masks, tally, level: Level::best() }
    }

    /// Its arrays, to be saved.
    pub(crate) fn parts(&self) -> Vec<Written<'_>> {
        let root = std::slice::from_ref(&self.root);
        vec![
            Written::new(Part::Root, root),
            Written::new(Part::Nodes, &self.lines),
            Written::new(Part::Blocks, &self.blocks),
        ]
    }

    /// The tree that saved arrays make, once they are known to be one over this mesh. O(nodes + blocks).
    ///
    /// # Errors
    /// [`Error::Format`] at the first fault, or lack of memory.
    pub(crate) fn from_parts(parts: &Parts<'_>, mesh: &Mesh) -> Result<Self> {
        let root = parts.get::<Node>(Part::Root)?;
        let &[root] = &root[..] else {
            return Err(parts.error(Place { part: Part::Root, byte: 0 }, format!("{} roots", root.len())));
        };
        let (lines, blocks) = (parts.get(Part::Nodes)?, parts.get(Part::Blocks)?);
        let tree = Self { root, ..Self::of_arrays(&mesh.bounds(), lines, blocks, mesh.mask_array()) };
        let tally = tree.tally_checked(mesh).map_err(|(place, fault)| parts.error(place, fault.0))?;
        Ok(Self { tally, ..tree })
    }

    /// The same tree, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The nearest hit; of equally near ones that with the smallest id.
    #[inline]
    pub fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let mut hit = None;
        self.cast::<leaf::Closest>(ray, probe, &mut hit);
        hit
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let mut is_hit = false;
        self.cast::<leaf::Any>(ray, probe, &mut is_hit);
        is_hit
    }

    /// Writes down what a ray finds.
    #[inline(always)]
    fn cast<C: Collector<Start = ()>>(&self, ray: &Ray, probe: &mut impl Probe, answer: &mut C::Output) {
        self.level.run(InPlace(trace::Walk::<_, C> { tree: self, ray, probe, start: () }, answer));
    }

    /// The nearest hit that `passes`.
    pub fn closest_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> Option<Hit> {
        self.level.run(trace::Walk::<_, leaf::ClosestWhere<'_>> { tree: self, ray, probe: &mut (), start: passes })
    }

    /// Whether there is a hit that `passes`.
    pub fn occluded_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> bool {
        self.level.run(trace::Walk::<_, leaf::AnyWhere<'_>> { tree: self, ray, probe: &mut (), start: passes })
    }

    /// All hits, nearest first, then by id, each shared edge owned by one triangle; `hits` is cleared first.
    pub fn all_hits<P: Probe>(&self, ray: &Ray, probe: &mut P, hits: &mut Vec<Hit>) {
        hits.clear();
        self.level.run(trace::Walk::<_, leaf::All<'_>> { tree: self, ray, probe, start: hits });
        leaf::in_order(hits);
    }

    /// The root, in a form of its own since it has no sibling.
    pub fn root(&self) -> Node {
        self.root
    }

    /// All other nodes, left and right children side by side.
    #[inline(always)]
    pub fn pairs(&self) -> &[[Node; 2]] {
        bytemuck::cast_slice(&self.lines)
    }

    /// How many leaves and references there are, and how deep they lie.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// Bytes of nodes and blocks, masks included.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.lines[..]) + size_of_val(&self.blocks[..]) + self.masks.as_ref().map_or(0, |m| 4 * m.len())
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        self.scale.unscaled(&self.bounds)
    }

    /// A hash of all arrays: equal for equal trees.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        hash.update(bytemuck::bytes_of(&self.root));
        hash.update(bytemuck::cast_slice(&self.lines));
        hash.update(bytemuck::cast_slice(&self.blocks));
        hash.digest()
    }
}

impl Batched for KdTree {
    type Costs = tile::Costs;

    fn part<C: Packed>(&self, rays: &[Ray], answers: &mut [C::Output], width: Option<usize>) -> Cost {
        self.level.run(tile::Part::<C> { tree: self, rays, answers, width })
    }

    fn counted<C: Packed>(&self, ray: &Ray, counts: &mut Counts, answer: &mut C::Output) {
        self.cast::<C>(ray, counts, answer);
    }
}

/// Grows the branches over a mesh's triangles within `bounds`, with at most so many references; the root is the last one.
pub(crate) fn grow<K: Kept>(
    clipper: &TriangleClipper<'_>,
    bounds: Aabb,
    spec: &KdSpec,
    heuristic: &dyn Heuristic,
    max_refs: usize,
    options: &BuildOptions<'_>,
) -> Result<Branches<K>> {
    let refs = references(clipper, options.threads != Some(1))?;
    Builder::new(clipper, heuristic, *spec, clipper.mesh.len(), options).build(refs, bounds, max_refs)
}

/// A reference to every triangle, whole.
fn references(clipper: &TriangleClipper<'_>, parallel: bool) -> Result<Vec<Reference>> {
    clipper.mesh.of_solid(parallel, |tri| Reference::new(tri.0, &Aabb::around(&clipper.corners(tri.0))))
}

/// How many references the budgets allow.
fn max_refs(n: usize, options: &BuildOptions<'_>) -> Result<usize> {
    let by_refs = options.max_refs.unwrap_or(8 * n + 1000);
    let by_bytes = options.max_bytes.map_or(usize::MAX, |b| b / BYTES_PER_REFERENCE);
    if by_refs < n {
        return Err(Error::OverBudget { what: "references", limit: by_refs });
    }
    Ok(by_refs.min(by_bytes.max(n)))
}
