//! Bounding volume hierarchies: a binary tree by binned SAH, cut into wide nodes, whose children are tested at once.
//!
//! `binary` grows the tree (`split`, `extent`), `spatial` one with cut triangles (`chop`), `reinsert` improves it, `collapse` cuts it into wide nodes, `layout` packs them; `trace` walks
//! them; `check` proves them.

mod binary;
mod check;
mod chop;
mod collapse;
mod extent;
mod guided;
mod layout;
mod link;
mod reinsert;
mod spatial;
mod spec;
mod split;
mod trace;
mod visits;

pub use layout::Tally;
pub use spec::{BvhSpec, Effort, Width};

use std::sync::Arc;

use binary::{BinaryNode, ByArea};
use collapse::{Costs, Cuts};
use extent::Extent;
use guided::ByRays;
use layout::Arrays;
use link::Link;
use spatial::Grown;
use split::Search;
use visits::Visits;

use crate::clip::TriangleClipper;
use crate::error::{Error, Result};
use crate::geom::{Aabb, Hit, Ray, Scale, TriId};
use crate::heuristic::Rdh;
use crate::leaf;
use crate::mem::reserve;
use crate::mesh::Mesh;
use crate::options::{BuildOptions, Watch};
use crate::probe::Probe;
use crate::simd::{Block, Boxes, LANES, Level};

/// A finished hierarchy with up to `W` children a node, and its own copies of the triangles. Plain arrays without pointers.
#[derive(Debug, Clone)]
pub struct Bvh<const W: usize> {
    scale: Scale,
    /// In scaled space, like all boxes.
    bounds: Aabb,
    magnitude: f32,
    nodes: Vec<Boxes<W>>,
    blocks: Vec<Block>,
    masks: Option<Arc<[u32]>>,
    tally: Tally,
    level: Level,
}

/// What a visit of a node costs, and a test of eight triangles.
const COSTS: Costs = Costs { node: 1.0, test: 0.6 };

impl<const W: usize> Bvh<W> {
    /// Builds a hierarchy over a mesh, cut into wide nodes by areas, or for the rays of a heuristic. O(N log N), and O(R log N) for R rays.
    ///
    /// # Errors
    /// [`Error::OverBudget`], [`Error::OutOfMemory`] or [`Error::Cancelled`].
    pub fn build(mesh: &Mesh, spec: &BvhSpec, guide: Option<&Rdh>, options: &BuildOptions<'_>) -> Result<Self> {
        if let Some(limit) = options.max_refs.filter(|&limit| limit < mesh.len()) {
            return Err(Error::OverBudget { what: "references", limit });
        }
        // Blocks beyond the last one that links can name would only be noticed after hours.
        let most = Link::MAX_BLOCKS * LANES;
        if mesh.len() > most {
            return Err(Error::OverBudget { what: "triangles", limit: most });
        }
        let watch = Watch::new(options, mesh.len());
        watch.check_cancelled()?;
        let bounds = mesh.bounds();
        let scale = Scale::of(&bounds);
        let bounds = scale.scaled(&bounds);
        let parallel = options.threads != Some(1);
        let (bins, leaf) = match spec.effort {
            Effort::Quick => (16, LANES),
            // Smaller leaves than blocks: where joining them pays, the cuts do it.
            Effort::Default => (32, 4),
            Effort::High => (32, 2),
        };
        let search = Search { level: Level::best(), parallel, bins, leaf };
        let mut primitives = primitives(mesh, scale)?;
        let Grown { nodes, ids } = if primitives.is_empty() {
            Grown::default()
        } else if spec.spatial {
            let most = options.max_refs.unwrap_or(usize::MAX).min(mesh.len() + mesh.len() / SPARE);
            let clipper = TriangleClipper { mesh, scale: scale.factor() };
            spatial::grow(primitives, &clipper, search, most - mesh.len(), &watch)?
        } else {
            let nodes = match guide {
                Some(rdh) => binary::grow(&mut primitives, search, &ByRays(rdh), &watch)?,
                _ => binary::grow(&mut primitives, search, &ByArea, &watch)?,
            };
            Grown { nodes, ids: ids(&primitives)? }
        };
        let nodes = match spec.effort {
            Effort::High => reinsert::reinsert(nodes, parallel, &watch)?,
            _ => nodes,
        };
        let weights = match guide {
            Some(rdh) => Visits::measure(&nodes, rdh, &watch)?,
            None => Visits::by_area(&nodes)?,
        };
        watch.check_cancelled()?;
        let cuts = Cuts::<W>::cheapest(&nodes, COSTS, |i| weights.chances[i])?;
        watch.check_cancelled()?;
        let counts = counts(&nodes)?;
        // Any-hit rays take the children in this order. Areas say too little about where rays are stopped to be worth dividing by a
        // cost; but where spatial splits made them, a large child that holds little is soon done with.
        let first = |i: usize| match guide {
            Some(_) => weights.stops[i] / cuts.cost(i).max(f32::MIN_POSITIVE),
            None if spec.spatial => weights.stops[i] / counts[i] as f32,
            None => weights.stops[i],
        };
        let arrays = layout::lay_out(&nodes, &ids, &cuts, first, |id| mesh.corners(TriId(id)), &watch)?;
        let Arrays { nodes, blocks, tally } = arrays;
        let (masks, magnitude) = (mesh.masks().map(Arc::from), bounds.magnitude());
        let tree = Self { scale, bounds, magnitude, nodes, blocks, masks, tally, level: Level::best() };
        match options.max_bytes {
            Some(limit) if tree.bytes() > limit => Err(Error::OverBudget { what: "bytes", limit }),
            _ => Ok(tree),
        }
    }

    /// The same tree, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The nearest hit; of equally near ones that with the smallest id.
    #[inline]
    pub fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.level.run(trace::Walk::<_, leaf::Closest, W> { tree: self, ray, probe, start: () })
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.level.run(trace::Walk::<_, leaf::Any, W> { tree: self, ray, probe, start: () })
    }

    /// All hits, nearest first, then by id, each shared edge owned by one triangle; `hits` is cleared first.
    pub fn all_hits<P: Probe>(&self, ray: &Ray, probe: &mut P, hits: &mut Vec<Hit>) {
        hits.clear();
        self.level.run(trace::Walk::<_, leaf::All<'_>, W> { tree: self, ray, probe, start: hits });
        leaf::in_order(hits);
    }

    /// How many nodes, leaves and references there are, and how deep they lie.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// Bytes of nodes and blocks, masks included.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..]) + self.masks.as_ref().map_or(0, |m| 4 * m.len())
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        self.unscaled(&self.bounds)
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
                    visit(self.unscaled(&node.get(lane)), depth, &self.blocks[link.block()].ids[lanes]);
                } else {
                    todo.push((link.index(), depth + 1));
                }
            }
        }
    }

    fn unscaled(&self, bounds: &Aabb) -> Aabb {
        let back = 1.0 / self.scale.factor();
        Aabb { min: bounds.min.map(|x| x * back), max: bounds.max.map(|x| x * back) }
    }

    /// A hash of all arrays: equal for equal trees.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        hash.update(Boxes::bytes(&self.nodes));
        hash.update(bytemuck::cast_slice(&self.blocks));
        hash.digest()
    }
}

/// The references below each node.
fn counts(nodes: &[BinaryNode]) -> Result<Vec<u32>> {
    let mut counts = Vec::new();
    reserve(&mut counts, nodes.len(), "nodes")?;
    counts.resize(nodes.len(), 0);
    // In preorder children come after their parents: backwards they are done first.
    for (i, node) in nodes.iter().enumerate().rev() {
        counts[i] = if node.is_interior() { counts[i + 1] + counts[node.right()] } else { node.0.count };
    }
    Ok(counts)
}

/// Rays of a heuristic that are counted in a node, unless its spec says otherwise: fewer than in a kd-tree, since the wide nodes' coarser
/// choices need no more.
pub(crate) const RAYS_COUNTED: u32 = 256;

/// Spatial splits may add one reference to so many.
const SPARE: usize = 2;

fn ids(primitives: &[Extent]) -> Result<Vec<u32>> {
    let mut ids = Vec::new();
    reserve(&mut ids, primitives.len(), "references")?;
    ids.extend(primitives.iter().map(|p| p.link));
    Ok(ids)
}

/// The box and id of every triangle, in scaled space.
fn primitives(mesh: &Mesh, scale: Scale) -> Result<Vec<Extent>> {
    let mut primitives = Vec::new();
    reserve(&mut primitives, mesh.len(), "references")?;
    primitives.extend((0..mesh.len() as u32).map(|id| {
        let corners = mesh.corners(TriId(id)).map(|c| c.map(|x| x * scale.factor()));
        Extent::new(&Aabb::around(&corners), id, 0)
    }));
    Ok(primitives)
}
