//! What subtrees grow on: the mesh, its space, how trees are built, and how many bytes there may be.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::part::{Parting, split_into_eight};
use super::runs;
use super::subtree::{Grown, Node, Subtree};
use crate::bvh::{Bvh, BvhSpec, ByArea, Chooser, Extent, Space};
use crate::error::Result;
use crate::geom::Aabb;
use crate::heuristic::Rdh;
use crate::mem::reserve;
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::simd::{Boxes, Level};

/// Subtrees of up to so many triangles grow at once and in whole.
pub(super) const WHOLE: usize = 1024;

/// What all subtrees of a lazy structure share.
#[derive(Debug)]
pub(super) struct Ground {
    pub(super) mesh: Mesh,
    pub(super) space: Space,
    /// How whole trees are built where nothing is known of rays.
    spec: BvhSpec,
    level: Level,
    most_bytes: usize,
    bytes: AtomicUsize,
}

impl Ground {
    pub(super) fn new(mesh: &Mesh, space: Space, spec: &BvhSpec, options: &BuildOptions<'_>) -> Self {
        let most_bytes = options.max_bytes.unwrap_or(usize::MAX);
        Self { mesh: mesh.clone(), space, spec: *spec, level: options.level(), most_bytes, bytes: AtomicUsize::new(0) }
    }

    /// Bytes of all that has grown or waits.
    pub(super) fn bytes(&self) -> usize {
        self.bytes.load(Ordering::Relaxed)
    }

    /// The instructions that build.
    pub(super) fn level(&self) -> Level {
        self.level
    }

    /// Accounts for more bytes, unless they would be too many.
    pub(super) fn take(&self, bytes: usize) -> bool {
        let more = |used: usize| used.checked_add(bytes).filter(|&sum| sum <= self.most_bytes);
        self.bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).is_ok()
    }

    /// What a subtree of these runs is to be: on this thread alone, by areas; nothing if it can't be had.
    pub(super) fn grow(&self, runs: &mut [Extent], depth: u32) -> Option<Grown> {
        if runs::count(runs) <= WHOLE {
            return self.tree(runs, &self.spec, None);
        }
        self.node(runs, depth, &Parting { chooser: &ByArea, level: self.level, parallel: false }, ())
    }

    /// A node over runs, whose order changes.
    pub(super) fn node<C: Chooser>(
        &self,
        runs: &mut [Extent],
        depth: u32,
        parting: &Parting<'_, C>,
        rays: C::Rays,
    ) -> Option<Grown> {
        let parts = split_into_eight(runs, depth, parting, rays).ok()?;
        let mut children = Vec::new();
        reserve(&mut children, parts.len(), "nodes").ok()?;
        let mut boxes = Boxes::NONE;
        for (lane, (bounds, range)) in parts.into_iter().enumerate() {
            boxes.set(lane, &bounds, 0);
            children.push(Subtree::new(copy(&runs[range]).ok()?, depth + 1));
        }
        // Runs only change hands.
        self.take(Node::BYTES).then(|| Grown::Node(Box::new(Node { boxes, children })))
    }

    /// A whole tree over runs.
    pub(super) fn tree(&self, runs: &[Extent], spec: &BvhSpec, guide: Option<&Rdh>) -> Option<Grown> {
        if runs.is_empty() {
            return None;
        }
        let options = BuildOptions { threads: Some(1), level: Some(self.level), ..BuildOptions::default() };
        let primitives = self.primitives(runs).ok()?;
        let tree = Bvh::of_part(&self.mesh, &self.space, primitives, spec, guide, &options).ok()?;
        self.take(tree.array_bytes() + size_of::<Bvh<8>>()).then(|| Grown::Tree(Box::new(tree)))
    }

    /// The boxes of the runs' triangles.
    fn primitives(&self, runs: &[Extent]) -> Result<Vec<Extent>> {
        let mut primitives = Vec::new();
        reserve(&mut primitives, runs::count(runs), "references")?;
        let factor = self.space.scale.factor();
        for tri in runs.iter().flat_map(|run| runs::triangles(&self.mesh, *run)) {
            let corners = self.mesh.corners(tri).map(|c| c.map(|x| x * factor));
            primitives.push(Extent::new(&Aabb::around(&corners), tri.0, 0));
        }
        Ok(primitives)
    }

    /// How whole trees are built where nothing is known of rays.
    pub(super) fn spec(&self) -> &BvhSpec {
        &self.spec
    }
}

impl Node {
    /// What a node takes.
    pub(super) const BYTES: usize = size_of::<Self>() + 8 * size_of::<Subtree>();
}

fn copy(runs: &[Extent]) -> Result<Vec<Extent>> {
    let mut copy = Vec::new();
    reserve(&mut copy, runs.len(), "runs of triangles")?;
    copy.extend_from_slice(runs);
    Ok(copy)
}
