//! A hierarchy that grows where rays come: for scenes that change, or are seen once, so that most of what a builder does would be for
//! rays that are never cast.
//!
//! ```text
//! build:    boxes of runs of triangles, O(n); the root
//! a ray     reaches a subtree for the first time:
//!             of more than some thousand triangles   up to eight subtrees of its runs, by a few binned splits
//!             else                                   a whole tree, by the ordinary builder, walked by the ordinary kernels
//! ```
//! What lies behind walls stays a list of runs. Hunt, Mark and Fussell, *Fast kd-tree Construction with an Adaptive Error-Bounded
//! Heuristic* (2006), and *Ray Tracing with the k-d tree built on demand* (2007) grow kd-trees so; Vinkler et al., *Parallel on-demand
//! hierarchy construction on contemporary GPUs* (2016), hierarchies. Where a profile of the rays to come is known (the previous frame's,
//! or a few in advance), what these reach grows at once, on all threads, and with more care where they come often.
//!
//! Answers are those of every other structure, bit for bit, whoever comes first: what has grown decides only what is tested. A subtree
//! grows on the thread whose ray reaches it; others that reach it meanwhile wait, and nobody waits once it is there. Where the budget of
//! bytes ([`BuildOptions::max_bytes`]) or memory is at its end, subtrees stay lists, and rays test all their triangles: slow, but never
//! wrong, and no query fails.
//!
//! `runs` makes runs, `part` parts them, `ground` grows subtrees (`subtree`), `ahead` those that sampled rays reach; `trace` walks them;
//! `check` proves them.

mod ahead;
mod check;
mod ground;
mod growth;
mod part;
mod runs;
mod subtree;
mod trace;

use std::sync::Arc;

use ahead::Ahead;
use ground::Ground;
use part::Parting;
use subtree::Subtree;

use crate::bvh::{self, BvhSpec, ByArea, Effort, Space};
use crate::error::{Error, Result};
use crate::geom::{Aabb, Hit, Ray};
use crate::heuristic::{Heuristic, Rdh, RdhSpec};
use crate::leaf;
use crate::mesh::Mesh;
use crate::options::{BuildOptions, Watch};
use crate::probe::Probe;
use crate::rays::Training;
use crate::simd::Level;

pub use growth::Growth;

/// A hierarchy that grows where rays come. Clones share it, and what grows.
#[derive(Debug, Clone)]
pub struct Lazy {
    tree: Arc<Tree>,
    level: Level,
}

/// What clones share.
#[derive(Debug)]
struct Tree {
    ground: Ground,
    root: Subtree,
}

impl Lazy {
    /// Makes ready to grow over a mesh: O(n). With rays, what they reach grows at once; `spec` says how carefully trees are built.
    ///
    /// # Errors
    /// [`Error::OverBudget`] if not even the runs of triangles may be held; [`Error::OutOfMemory`] or [`Error::Cancelled`].
    pub fn build(
        mesh: &Mesh,
        spec: &BvhSpec,
        rays: Option<(&RdhSpec, &Training)>,
        options: &BuildOptions<'_>,
    ) -> Result<Self> {
        bvh::check_size(mesh, options)?;
        let watch = Watch::new(options, mesh.len());
        watch.check_cancelled()?;
        let parallel = options.threads != Some(1);
        let (runs, in_mesh) = runs::runs(mesh, options.level(), parallel, &watch)?;
        let space = Space::of(&in_mesh);
        // Rays that were not foreseen are few.
        let unforeseen = if rays.is_some() { BvhSpec { effort: Effort::Quick, ..*spec } } else { *spec };
        let ground = Ground::new(mesh, space, &unforeseen, options);
        if !ground.take(size_of_val(&runs[..])) {
            return Err(Error::OverBudget { what: "bytes", limit: options.max_bytes.unwrap_or(usize::MAX) });
        }
        let tree = Tree { root: Subtree::new(runs, 0), ground };
        match rays {
            Some((rdh, training)) => {
                let cap = rdh.cap.or(Some(bvh::RAYS_COUNTED));
                let rdh = RdhSpec { cap, ..*rdh };
                let rdh = Rdh::new(&rdh, training, space.scale.factor()).with_level(options.level());
                let root = rdh.root(&space.bounds);
                let all = rdh.weigh_node(&root);
                let ahead = Ahead { ground: &tree.ground, rdh: &rdh, all, careful: spec, parallel, watch: &watch };
                ahead.grow(&tree.root, &root)?;
            }
            None => tree.grow_root(parallel),
        }
        Ok(Self { tree: Arc::new(tree), level: options.level() })
    }

    /// The same structure, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The nearest hit; of equally near ones that with the smallest id.
    #[inline]
    pub fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.level.run(trace::Walk::<_, leaf::Closest> { tree: &self.tree, ray, probe, start: () })
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.level.run(trace::Walk::<_, leaf::Any> { tree: &self.tree, ray, probe, start: () })
    }

    /// The nearest hit that `passes`.
    pub fn closest_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> Option<Hit> {
        self.level.run(trace::Walk::<_, leaf::ClosestWhere<'_>> {
            tree: &self.tree,
            ray,
            probe: &mut (),
            start: passes,
        })
    }

    /// Whether there is a hit that `passes`.
    pub fn occluded_where(&self, ray: &Ray, passes: &mut dyn FnMut(&Hit) -> bool) -> bool {
        self.level.run(trace::Walk::<_, leaf::AnyWhere<'_>> { tree: &self.tree, ray, probe: &mut (), start: passes })
    }

    /// All hits, nearest first, then by id, each shared edge owned by one triangle; `hits` is cleared first.
    pub fn all_hits<P: Probe>(&self, ray: &Ray, probe: &mut P, hits: &mut Vec<Hit>) {
        hits.clear();
        self.level.run(trace::Walk::<_, leaf::All<'_>> { tree: &self.tree, ray, probe, start: hits });
        leaf::in_order(hits);
    }

    /// The box of everything that can be hit.
    pub fn bounds(&self) -> Aabb {
        let Space { scale, bounds, .. } = self.tree.ground.space;
        scale.unscaled(&bounds)
    }

    /// Bytes of all that has grown so far, or waits, masks included.
    pub fn bytes(&self) -> usize {
        self.tree.ground.bytes() + self.tree.ground.mesh.masks().map_or(0, size_of_val)
    }
}

impl Tree {
    /// Every ray needs the root, and a large one is work for all threads: it is there before there are rays.
    fn grow_root(&self, parallel: bool) {
        if self.root.with_waiting(|runs| runs::count(runs)) > ground::WHOLE {
            let parting = Parting { chooser: &ByArea, level: self.ground.level(), parallel };
            self.root.grow_alone(|runs| self.ground.node(runs, 0, &parting, ()));
        }
    }
}
