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
use super::split::Search;
use super::visits::Visits;
use super::{Bvh, BvhSpec, Effort, Splitter, reinsert, spatial};
use crate::clip::TriangleClipper;
use crate::error::{Error, Result};
use crate::geom::{Aabb, Scale};
use crate::heuristic::{Heuristic, Rdh, Sah};
use crate::kd::{KdSpec, Prune};
use crate::mem::reserve;
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
        let in_mesh = mesh.bounds();
        let scale = Scale::of(&in_mesh);
        let build = Build { mesh, spec, guide, options, scale, bounds: scale.scaled(&in_mesh), watch: &watch };
        let Arrays { nodes, blocks, tally } = build.pack(build.grow()?)?;
        let arrays = Self::of_arrays(mesh, nodes.into(), blocks.into());
        let tree = Self { tally, level: options.level(), ..arrays };
        match options.max_bytes {
            Some(limit) if tree.bytes() > limit => Err(Error::OverBudget { what: "bytes", limit }),
            _ => Ok(tree),
        }
    }
}

/// Refuses what would only fail after hours: more triangles than links can name, or than references are allowed.
fn check_size(mesh: &Mesh, options: &BuildOptions<'_>) -> Result<()> {
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

/// What all stages know.
struct Build<'a> {
    mesh: &'a Mesh,
    spec: &'a BvhSpec,
    guide: Option<&'a Rdh>,
    options: &'a BuildOptions<'a>,
    scale: Scale,
    bounds: Aabb,
    watch: &'a Watch<'a>,
}

impl Build<'_> {
    /// The binary tree, improved as the effort says.
    fn grow(&self) -> Result<Grown> {
        if self.mesh.is_empty() {
            return Ok(Grown::default());
        }
        let grown = match self.spec.splitter {
            Splitter::Objects => self.grow_whole(self.primitives()?),
            Splitter::Spatial => self.grow_cutting(self.primitives()?),
            Splitter::KdTree => self.grow_cells(),
        };
        let Grown { nodes, ids } = grown?;
        let nodes = match self.spec.effort {
            Effort::High => reinsert::reinsert(nodes, self.is_parallel(), self.watch)?,
            _ => nodes,
        };
        Ok(Grown { nodes, ids })
    }

    fn grow_cutting(&self, references: Vec<Extent>) -> Result<Grown> {
        let spare = self.most_refs() - self.mesh.len();
        spatial::grow(references, &self.clipper(), self.search(), spare, self.watch)
    }

    fn grow_cells(&self) -> Result<Grown> {
        let prune = if self.guide.is_some() { Prune::Visits } else { Prune::Area };
        let heuristic: &dyn Heuristic = match self.guide {
            Some(rdh) => rdh,
            None => &Sah,
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
        let nodes = match self.guide {
            Some(rdh) => binary::grow(&mut primitives, self.search(), &ByRays(rdh), self.watch)?,
            None => binary::grow(&mut primitives, self.search(), &ByArea, self.watch)?,
        };
        let mut ids = Vec::new();
        reserve(&mut ids, primitives.len(), "references")?;
        ids.extend(primitives.iter().map(|p| p.link));
        Ok(Grown { nodes, ids })
    }

    /// The box and id of every triangle, in scaled space.
    fn primitives(&self) -> Result<Vec<Extent>> {
        self.mesh.of_solid(self.is_parallel(), |tri| {
            let corners = self.mesh.corners(tri).map(|c| c.map(|x| x * self.scale.factor()));
            Extent::new(&Aabb::around(&corners), tri.0, 0)
        })
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
    fn pack<B: Lanes, const W: usize>(&self, grown: Grown) -> Result<Arrays<B, W>> {
        let Grown { nodes, ids } = grown;
        let weights = self.weights(&nodes)?;
        self.watch.check_cancelled()?;
        let repeated = self.cuts_triangles().then_some(&ids[..]);
        let chance = |i: usize| weights.chances[i];
        let cuts = Cuts::<W>::cheapest(&nodes, repeated, COSTS, chance, self.is_parallel(), self.watch)?;
        // Any-hit rays take the children in this order. Areas say too little about where rays are stopped to be worth dividing by a
        // cost; but where triangles were cut, a large child that holds little is soon done with.
        let order = |i: usize| match self.guide {
            Some(_) => weights.stops[i] / cuts.cost(i).max(f32::MIN_POSITIVE),
            None if self.cuts_triangles() => weights.stops[i] / cuts.count(i) as f32,
            None => weights.stops[i],
        };
        let put = |block: &mut B, lane, id| block.put(lane, id, self.mesh);
        let (parallel, watch) = (self.is_parallel(), self.watch);
        Draft { binary: &nodes, ids: &ids, cuts: &cuts, order, put, parallel, watch }.lay_out()
    }

    fn weights(&self, nodes: &[BinaryNode]) -> Result<Visits> {
        match self.guide {
            Some(rdh) => Visits::measure(nodes, rdh, self.watch),
            None => Visits::by_area(nodes),
        }
    }
}
