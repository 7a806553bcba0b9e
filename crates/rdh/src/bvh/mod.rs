//! Bounding volume hierarchies: a binary tree by binned SAH, cut into wide nodes, whose children are tested at once.
//!
//! `build` leads through the stages: `binary` grows the tree over boxes (`extent`) by areas (`split`, `sweep`) or by sampled rays
//! (`guided`), `spatial` one with cut triangles (`chop`), `cells` one from a kd-tree; `reinsert` improves it, for rays as `crowd`
//! counts them; `visits` says how often rays come to each node, `collapse` cuts it into wide nodes, `order` says which child any-hit
//! rays try first, `layout` packs them, and their words (`link`) say what lies below. `trace` walks them;
//! `check` proves them.

mod binary;
mod build;
mod cells;
mod check;
mod chop;
mod collapse;
mod crowd;
mod extent;
mod grown;
mod guided;
mod layout;
mod leaves;
mod link;
mod order;
mod recent;
mod reinsert;
mod spatial;
mod spec;
mod split;
mod strands;
mod sweep;
mod tile;
pub(crate) mod trace;
mod visits;

pub(crate) use binary::{ByArea, Chooser, Node as Todo};
pub(crate) use build::{Space, check_size};
pub(crate) use extent::Extent;
pub(crate) use guided::ByRays;
pub use layout::Tally;
pub(crate) use leaves::Leaves;
pub use leaves::{Copies, Shared};
pub use spec::{BvhSpec, Effort, SplitSearch, Splitter, Triangles, When, Width};
pub(crate) use split::{Centres, Search};

use link::Link;

use crate::error::Result;
use crate::geom::{Aabb, Hit, Ray, Scale};
use crate::leaf::{self, Collector};
use crate::mem::{Array, bytes_of};
use crate::mesh::Mesh;
use crate::parts::{Part, Parts, Written};
use crate::probe::{Counts, Probe};
use crate::simd::{Boxes, InPlace, Lanes, Level};
use crate::tile::{Batched, Cost, Packed};

/// A finished hierarchy with up to `W` children a node, and its own copies of the triangles, or indices to the mesh's. Plain arrays
/// without pointers.
#[derive(Debug, Clone)]
pub struct Bvh<const W: usize, L = Copies> {
    scale: Scale,
    /// In scaled space, like all boxes.
    bounds: Aabb,
    magnitude: f32,
    nodes: Array<Boxes<W>>,
    leaves: L,
    masks: Option<Array<u32>>,
    tally: Tally,
    level: Level,
}

/// Rays of a heuristic that are counted in a node, unless its spec says otherwise: fewer than in a kd-tree, since the wide nodes' coarser
/// choices need no more.
pub(crate) const RAYS_COUNTED: u32 = 64;

#[expect(private_bounds, reason = "the forms of leaves are a closed set")]
impl<const W: usize, L: Leaves> Bvh<W, L> {
    /// Over a mesh whose box is given; with nothing counted yet.
    fn of_arrays(mesh: &Mesh, in_mesh: &Aabb, nodes: Array<Boxes<W>>, blocks: Array<L::Block>) -> Self {
        let scale = Scale::of(in_mesh);
        let bounds = scale.scaled(in_mesh);
        let (magnitude, tally, masks) = (bounds.magnitude(), Tally::default(), mesh.mask_array());
        let leaves = L::new(blocks, mesh);
        Self { scale, bounds, magnitude, nodes, leaves, masks, tally, level: Level::best() }
    }

    /// Its arrays, to be saved.
    pub(crate) fn parts(&self) -> Vec<Written<'_>> {
        vec![Written::new(Part::Nodes, &self.nodes), Written::new(Part::Blocks, self.leaves.blocks())]
    }

    /// The tree that saved arrays make, once they are known to be one over this mesh. O(nodes + blocks).
    ///
    /// # Errors
    /// [`Error::Format`](crate::Error::Format) at the first fault, or lack of memory.
    pub(crate) fn from_parts(parts: &Parts<'_>, mesh: &Mesh) -> Result<Self> {
        let (nodes, blocks) = (parts.get(Part::Nodes)?, parts.get(Part::Blocks)?);
        let tree = Self::of_arrays(mesh, &mesh.bounds(), nodes, blocks);
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
        self.level.run(InPlace(trace::Walk::<_, C, L, W> { tree: self, ray, probe, start: () }, answer));
    }

    /// The nearest hit that `passes`.
    pub fn closest_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> Option<Hit> {
        self.level.run(trace::Walk::<_, leaf::ClosestWhere<'_>, L, W> {
            tree: self,
            ray,
            probe: &mut (),
            start: passes,
        })
    }

    /// Whether there is a hit that `passes`.
    pub fn occluded_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> bool {
        self.level.run(trace::Walk::<_, leaf::AnyWhere<'_>, L, W> { tree: self, ray, probe: &mut (), start: passes })
    }

    /// All hits, nearest first, then by id, each shared edge owned by one triangle; `hits` is cleared first.
    pub fn all_hits<P: Probe>(&self, ray: &Ray, probe: &mut P, hits: &mut Vec<Hit>) {
        hits.clear();
        self.level.run(trace::Walk::<_, leaf::All<'_>, L, W> { tree: self, ray, probe, start: hits });
        leaf::in_order(hits);
    }

    /// Which instructions trace it.
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Its nodes.
    #[cfg(feature = "twin")]
    pub(crate) fn nodes(&self) -> &Array<Boxes<W>> {
        &self.nodes
    }

    /// Its leaves.
    #[cfg(feature = "twin")]
    pub(crate) fn leaves(&self) -> &L {
        &self.leaves
    }

    /// A ray, made ready for its boxes.
    #[inline(always)]
    pub(crate) fn box_ray<K: crate::simd::Kernels>(&self, ray: &Ray) -> Option<K::BoxRay> {
        K::box_ray(ray, self.scale, self.magnitude)
    }

    /// How many nodes, leaves and references there are, and how deep they lie.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// Bytes of nodes and blocks, masks included, and the mesh's vertices where leaves index them.
    pub fn bytes(&self) -> usize {
        self.array_bytes() + self.leaves.other_bytes() + self.masks.as_ref().map_or(0, |m| 4 * m.len())
    }

    /// Bytes of nodes and blocks.
    pub(crate) fn array_bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.leaves.blocks()[..])
    }

    /// Leads a ray through it that is made ready for its space, and may have been through other trees; whether the ray goes on.
    #[inline(always)]
    pub(crate) fn lead<K: crate::simd::Kernels, T: trace::Caster<W>, P: Probe>(
        &self,
        caster: &mut T,
        probe: &mut P,
    ) -> bool {
        trace::walk::<K, _, _, _, W>(&self.nodes, &self.leaves, caster, probe)
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        self.scale.unscaled(&self.bounds)
    }

    /// Visits all leaves: box, depth, triangles.
    pub fn cells(&self, visit: &mut dyn FnMut(Aabb, usize, &[u32])) {
        let mut todo = vec![(0, 1)];
        while let Some((node, depth)) = todo.pop() {
            let node: &Boxes<W> = &self.nodes[node];
            for lane in (0..W).filter(|&lane| node.is_present(lane)) {
                let link = Link(node.links[lane]);
                if link.is_leaf() {
                    let lanes = link.lane() as usize..(link.lane() + link.count()) as usize;
                    visit(
                        self.scale.unscaled(&node.get(lane)),
                        depth,
                        &self.leaves.blocks()[link.block()].ids()[lanes],
                    );
                } else {
                    todo.push((link.index(), depth + 1));
                }
            }
        }
    }

    /// A hash of all arrays: equal for equal trees.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        hash.update(bytes_of(&self.nodes));
        hash.update(bytes_of(self.leaves.blocks()));
        hash.digest()
    }
}

#[expect(private_bounds, reason = "the forms of leaves are a closed set")]
impl<L: Leaves> Bvh<8, L> {
    /// The same memory, its leaves as any form of them.
    pub(crate) fn with_any_leaves(&self) -> Bvh<8, leaves::AnyLeaves> {
        let Self { scale, bounds, magnitude, ref nodes, ref leaves, ref masks, tally, level } = *self;
        Bvh { scale, bounds, magnitude, nodes: nodes.clone(), leaves: leaves.any(), masks: masks.clone(), tally, level }
    }
}

impl<L: Leaves> Batched for Bvh<8, L> {
    type Costs = tile::Costs;

    fn part<C: Packed>(&self, rays: &[Ray], answers: &mut [C::Output], width: Option<usize>) -> Cost {
        let (tree, bytes) = (&self.with_any_leaves(), self.bytes());
        let alone = &|ray: &Ray, answer: &mut C::Output| self.cast::<C>(ray, &mut (), answer);
        self.level.run(tile::Part::<C> { tree, alone, bytes, rays, answers, width })
    }

    fn counted<C: Packed>(&self, ray: &Ray, counts: &mut Counts, answer: &mut C::Output) {
        self.cast::<C>(ray, counts, answer);
    }
}
