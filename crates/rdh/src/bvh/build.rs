//! A build, stage by stage: the boxes of triangles, a binary tree over them, wide nodes, and the arrays that rays walk.

use super::binary::{self, BinaryNode, ByArea};
use super::cells::{self, Cells};
use super::collapse::{Costs, Cuts};
use super::extent::Extent;
use super::grown::Grown;
use super::guided::ByRays;
use super::layout::{Arrays, Draft};
use super::leaves::Leaves;
use super::link::Link;
use super::order::Asker;
use super::split::Search;
use super::{Bvh, BvhSpec, Effort, Splitter, order, reinsert, spatial, visits};
use crate::clip::TriangleClipper;
use crate::error::{Error, Result};
use crate::geom::{Aabb, Ray, RayFrame, Scale, TriId, Vec3, hit_triangle};
use crate::heuristic::{By, Heuristic, Rdh, Sah, Stages};
use crate::kd::{KdSpec, Prune};
use crate::mem::{joined, reserve};
use crate::mesh::Mesh;
use crate::options::{BuildOptions, Watch};
use crate::simd::{LANES, Lanes};

#[expect(private_bounds, reason = "the forms of leaves are a closed set")]
impl<const W: usize, L: Leaves> Bvh<W, L> {
    /// Builds a hierarchy over a mesh, cut into wide nodes by areas, or for the rays of a heuristic. O(N log N), and O(R log N) for R rays.
    ///
    /// # Errors
    /// [`Error::OverBudget`], [`Error::OutOfMemory`] or [`Error::Cancelled`].
    pub fn build(mesh: &Mesh, spec: &BvhSpec, guide: Option<&Rdh>, options: &BuildOptions<'_>) -> Result<Self> {
        check_size(mesh, options)?;
        let watch = Watch::new(options, mesh.len());
        watch.check_cancelled()?;
        let in_mesh = mesh.bounds_by(options.threads != Some(1));
        let scale = Scale::of(&in_mesh);
        let (bounds, tracked) = (scale.scaled(&in_mesh), guide.map(|rdh| rdh.thinned(RAYS_TRACKED)));
        let build = Build { mesh, spec, guide, tracked, options, scale, bounds, watch: &watch };
        let Arrays { nodes, blocks, tally } = build.pack(build.grow()?)?;
        let arrays = Self::of_arrays(mesh, &in_mesh, nodes.into(), blocks.into());
        let tree = Self { tally, level: options.level(), ..arrays };
        match options.max_bytes {
            Some(limit) if tree.bytes() > limit => Err(Error::OverBudget { what: "bytes", limit }),
            _ => Ok(tree),
        }
    }
}

/// The space of a structure that other structures are parts of: one ray is made ready for all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Space {
    pub(crate) scale: Scale,
    /// Scaled.
    pub(crate) bounds: Aabb,
    /// Of the bounds.
    pub(crate) magnitude: f32,
}

impl Space {
    /// The space in which a box is stored.
    pub(crate) fn of(in_mesh: &Aabb) -> Self {
        let scale = Scale::of(in_mesh);
        let bounds = scale.scaled(in_mesh);
        Self { scale, bounds, magnitude: bounds.magnitude() }
    }
}

impl<const W: usize> Bvh<W> {
    /// A hierarchy over some of a mesh's triangles, not none, given by their boxes and ids, in the space of a larger structure.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub(crate) fn of_part(
        mesh: &Mesh,
        space: &Space,
        primitives: Vec<Extent>,
        spec: &BvhSpec,
        guide: Option<&Rdh>,
        options: &BuildOptions<'_>,
    ) -> Result<Self> {
        let watch = Watch::new(options, primitives.len());
        let Space { scale, bounds, magnitude } = *space;
        let tracked = guide.map(|rdh| rdh.thinned(RAYS_TRACKED));
        let build = Build { mesh, spec, guide, tracked, options, scale, bounds, watch: &watch };
        let grown = build.improve(build.grow_whole(primitives)?)?;
        let bounds = grown.0.nodes.first().map_or(Aabb::EMPTY, |root| root.0.bounds());
        let Arrays { nodes, blocks, tally } = build.pack(grown)?;
        let (leaves, masks, level) = (Leaves::new(blocks.into(), mesh), mesh.mask_array(), options.level());
        Ok(Self { scale, bounds, magnitude, nodes: nodes.into(), leaves, masks, tally, level })
    }
}

/// Refuses what would only fail after hours: more triangles than links can name, or than references are allowed.
pub(crate) fn check_size(mesh: &Mesh, options: &BuildOptions<'_>) -> Result<()> {
    let most = Link::MAX_BLOCKS * LANES;
    if mesh.len() > most {
        return Err(Error::OverBudget { what: "triangles", limit: most });
    }
    match options.max_refs {
        Some(limit) if limit < mesh.len() => Err(Error::OverBudget { what: "references", limit }),
        _ => Ok(()),
    }
}

/// What a visit of a node costs, and a test of eight triangles.
const COSTS: Costs = Costs { node: 1.0, test: 0.6 };

/// Cutting triangles may add one reference to so many. A kd-tree that may cut more (2, 4 or 8 references a triangle) makes no faster a
/// hierarchy, but a larger one (docs/measurements.md).
const ONE_SPARE_IN: usize = 2;

/// References whose ids one thread lists.
const AT_ONCE: usize = 1 << 13;

/// Sampled rays that are followed down the tree; more gain nothing.
const RAYS_TRACKED: usize = 4096;

/// What all stages know.
struct Build<'a> {
    mesh: &'a Mesh,
    spec: &'a BvhSpec,
    guide: Option<&'a Rdh>,
    /// A fair part of its rays.
    tracked: Option<Rdh>,
    options: &'a BuildOptions<'a>,
    scale: Scale,
    bounds: Aabb,
    watch: &'a Watch<'a>,
}

impl Build<'_> {
    /// The binary tree, improved as the effort says; and how often rays visit its nodes, if that has been found out.
    fn grow(&self) -> Result<(Grown, Option<Vec<f32>>)> {
        if self.mesh.solid().next().is_none() {
            return Ok((Grown::default(), None));
        }
        let grown = match self.spec.splitter {
            Splitter::Objects => self.grow_whole(self.primitives()?),
            Splitter::Spatial => self.grow_cutting(self.primitives()?),
            Splitter::KdTree => self.grow_cells(),
        };
        self.improve(grown?)
    }

    /// Moves subtrees to better places: for the rays as far as the effort allows, by areas only if it is high.
    fn improve(&self, Grown { nodes, ids }: Grown) -> Result<(Grown, Option<Vec<f32>>)> {
        let rounds = match self.spec.effort {
            Effort::Quick => 0,
            Effort::Default => 4,
            Effort::High => reinsert::ROUNDS,
        };
        let (nodes, visits) = match (self.guide_of(|stages| stages.moves), self.spec.effort) {
            (Some(rdh), Effort::Default | Effort::High) => {
                let (nodes, visits) = reinsert::reinsert_for(rdh, nodes, rounds, self.is_parallel(), self.watch)?;
                (nodes, Some(visits))
            }
            (None, Effort::High) => (reinsert::reinsert(nodes, self.is_parallel(), self.watch)?, None),
            _ => (nodes, None),
        };
        Ok((Grown { nodes, ids }, visits))
    }

    fn grow_cutting(&self, references: Vec<Extent>) -> Result<Grown> {
        let spare = self.most_refs() - self.mesh.len();
        spatial::grow(references, &self.clipper(), self.search(), spare, self.watch)
    }

    fn grow_cells(&self) -> Result<Grown> {
        let (prune, heuristic): (_, &dyn Heuristic) = match self.guide.filter(|rdh| rdh.stages().splits == By::Rays) {
            Some(rdh) => (Prune::Visits, rdh),
            None => (Prune::Area, &Sah),
        };
        let spec = KdSpec { prune, ..KdSpec::default() };
        let cells = Cells { clipper: &self.clipper(), bounds: self.bounds, spec, heuristic, most: self.most_refs() };
        cells::grow(&cells, self.search(), self.options)
    }

    fn clipper(&self) -> TriangleClipper<'_> {
        TriangleClipper { mesh: self.mesh, scale: self.scale.factor() }
    }

    /// How many references there may be where triangles are cut.
    fn most_refs(&self) -> usize {
        let n = self.mesh.len();
        self.options.max_refs.unwrap_or(usize::MAX).min(n + n / ONE_SPARE_IN)
    }

    fn grow_whole(&self, mut primitives: Vec<Extent>) -> Result<Grown> {
        let nodes = match self.guide_of(|stages| stages.splits) {
            Some(rdh) => binary::grow(&mut primitives, self.search(), &ByRays(rdh), self.watch)?,
            None => binary::grow(&mut primitives, self.search(), &ByArea, self.watch)?,
        };
        let chunks: Vec<&[Extent]> = primitives.chunks(AT_ONCE).collect();
        let ids = joined(&chunks, self.is_parallel(), "references", |_, p| p.link)?;
        Ok(Grown { nodes, ids })
    }

    /// The box and id of every triangle, in scaled space.
    fn primitives(&self) -> Result<Vec<Extent>> {
        self.mesh.of_solid(self.is_parallel(), |tri| Extent::new(&Aabb::around(&self.corners(tri.0)), tri.0, 0))
    }

    fn search(&self) -> Search {
        let (bins, leaf) = match self.spec.effort {
            Effort::Quick => (16, LANES),
            // Smaller leaves than blocks: where joining them pays, the cuts do it.
            Effort::Default => (32, 4),
            Effort::High => (32, 2),
        };
        Search { level: self.options.level(), parallel: self.is_parallel(), split: self.spec.split, bins, leaf }
    }

    fn cuts_triangles(&self) -> bool {
        self.spec.splitter != Splitter::Objects
    }

    fn is_parallel(&self) -> bool {
        self.options.threads != Some(1)
    }

    /// Wide nodes and blocks of triangles.
    fn pack<B: Lanes, const W: usize>(&self, (grown, visits): (Grown, Option<Vec<f32>>)) -> Result<Arrays<B, W>> {
        let Grown { nodes, ids } = grown;
        let visits = match (self.guide_of(|stages| stages.cuts), visits) {
            (Some(_), Some(visits)) => Some(visits),
            (Some(rdh), None) => Some(visits::measure(&nodes, rdh, self.watch, |_, _| ())?),
            (None, _) => None,
        };
        let visits = |i: usize| visits.as_ref().map_or_else(|| nodes[i].0.half_area(), |visits| visits[i]);
        self.watch.check_cancelled()?;
        let repeated = self.cuts_triangles().then_some(&ids[..]);
        let cuts = Cuts::<W>::cheapest(&nodes, repeated, COSTS, visits, self.is_parallel(), self.watch)?;
        let order = self.order_by_rays(&nodes, &ids, &cuts)?;
        let order = |i: usize| order.as_ref().map_or_else(|| self.order_by_area(&nodes, &cuts, i), |order| order[i]);
        let put = |block: &mut B, lane, id| block.put(lane, id, self.mesh);
        let (parallel, watch) = (self.is_parallel(), self.watch);
        Draft { binary: &nodes, ids: &ids, cuts: &cuts, order, put, parallel, watch }.lay_out()
    }

    /// Any-hit rays take those children first that get the highest numbers.
    fn order_by_area<const W: usize>(&self, nodes: &[BinaryNode], cuts: &Cuts<W>, node: usize) -> f32 {
        let area = nodes[node].0.half_area();
        // Areas say too little about where rays are stopped to be worth dividing by a cost; but where triangles were cut, a large
        // child that holds little is soon done with.
        if self.cuts_triangles() { area / cuts.count(node) as f32 } else { area }
    }

    /// The same numbers where rays have something to say about them.
    fn order_by_rays<const W: usize>(
        &self,
        nodes: &[BinaryNode],
        ids: &[u32],
        cuts: &Cuts<W>,
    ) -> Result<Option<Vec<f32>>> {
        let Some(rdh) = self.guide.filter(|rdh| rdh.stages().order == By::Rays) else { return Ok(None) };
        let mut order = Vec::new();
        reserve(&mut order, nodes.len(), "order")?;
        order.extend((0..nodes.len()).map(|i| self.order_by_area(nodes, cuts, i)));
        // All rays are asked who asks for any hit: there may be few.
        let askers = Asker::all(rdh, self.bounds.magnitude());
        let hits = |asker: &Asker, node| self.is_hit_below(nodes, ids, node, &asker.ray);
        order::score(nodes, cuts, COSTS, &askers, hits, &mut order, self.watch)?;
        Ok(Some(order))
    }

    /// Whether a ray, in scaled space, hits a triangle below a binary node.
    fn is_hit_below(&self, nodes: &[BinaryNode], ids: &[u32], node: usize, ray: &Ray) -> bool {
        let this = &nodes[node];
        if this.is_interior() {
            return [node + 1, this.right()].into_iter().any(|child| self.is_hit_below(nodes, ids, child, ray));
        }
        let frame = RayFrame::new(ray);
        ids[this.range()].iter().any(|&id| {
            let is_seen = self.mesh.masks().is_none_or(|masks| masks[id as usize] & ray.mask != 0);
            is_seen && hit_triangle(&frame, &self.corners(id), TriId(id)).is_some()
        })
    }

    /// In scaled space.
    fn corners(&self, id: u32) -> [Vec3; 3] {
        self.mesh.corners(TriId(id)).map(|c| c.map(|x| x * self.scale.factor()))
    }

    /// The rays, if a stage is to know them.
    fn guide_of(&self, stage: impl Fn(&Stages) -> By) -> Option<&Rdh> {
        self.tracked.as_ref().filter(|rdh| stage(&rdh.stages()) == By::Rays)
    }
}
