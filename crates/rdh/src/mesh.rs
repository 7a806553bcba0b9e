//! Triangle meshes that are valid by construction.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::geom::{Aabb, TriId, Vec3};
use crate::mem::{Array, bytes_of, made};

/// Triangles that one thread looks at.
const CHUNK: usize = 1 << 13;

/// A triangle mesh: finite vertices, indices in range, at most 2³⁰ triangles.
///
/// It can only be made by [`Mesh::new`], so whoever holds one need not check it again.
/// Zero-area triangles are allowed (no ray hits them), and so is the empty mesh. Clones share their memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    positions: Array<Vec3>,
    triangles: Array<[u32; 3]>,
    masks: Option<Array<u32>>,
}

impl Mesh {
    /// The largest number of triangles.
    pub const MAX_TRIANGLES: usize = 1 << 30;

    /// Checks vertices and indices, in O(n).
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::IndexOutOfRange`] or [`Error::TooMany`], naming the first culprit.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        Self::of_arrays(positions.into(), triangles.into())
    }

    /// [`Self::new`], of arrays that may lie anywhere.
    pub(crate) fn of_arrays(positions: Array<Vec3>, triangles: Array<[u32; 3]>) -> Result<Self> {
        Self::check_size(positions.len(), triangles.len())?;
        for (vertex, p) in positions.iter().enumerate() {
            if let Some(axis) = p.iter().position(|x| !x.is_finite()) {
                return Err(Error::NotFinite { vertex, axis, value: p[axis] });
            }
        }
        Self::check_indices(&triangles, positions.len())?;
        Ok(Self { positions, triangles, masks: None })
    }

    /// Whether there are not too many vertices and triangles.
    pub(crate) fn check_size(vertices: usize, triangles: usize) -> Result<()> {
        limit("triangles", triangles, Self::MAX_TRIANGLES)?;
        limit("vertices", vertices, u32::MAX as usize)
    }

    /// Whether all indices are in range.
    pub(crate) fn check_indices(triangles: &[[u32; 3]], vertices: usize) -> Result<()> {
        for (triangle, t) in triangles.iter().enumerate() {
            if let Some(&index) = t.iter().find(|&&i| i as usize >= vertices) {
                return Err(Error::IndexOutOfRange { triangle, index, vertices });
            }
        }
        Ok(())
    }

    /// Gives each triangle a mask; a ray sees it when `ray.mask & mask != 0`. The default is all ones.
    ///
    /// # Errors
    /// [`Error::WrongLength`] unless there is one mask a triangle.
    pub fn with_masks(self, masks: Vec<u32>) -> Result<Self> {
        self.with_mask_array(masks.into())
    }

    /// [`Self::with_masks`], of an array that may lie anywhere.
    pub(crate) fn with_mask_array(mut self, masks: Array<u32>) -> Result<Self> {
        if masks.len() != self.triangles.len() {
            return Err(Error::WrongLength { what: "masks", got: masks.len(), expected: self.triangles.len() });
        }
        self.masks = Some(masks);
        Ok(self)
    }

    /// The vertices.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// The vertices, to be held.
    pub(crate) fn position_array(&self) -> Array<Vec3> {
        self.positions.clone()
    }

    /// The triangles, three vertex indices each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The masks, where there are any.
    pub fn masks(&self) -> Option<&[u32]> {
        self.masks.as_deref()
    }

    /// The masks, to be held.
    pub(crate) fn mask_array(&self) -> Option<Array<u32>> {
        self.masks.clone()
    }

    /// A hash of all vertices, triangles and masks: equal for equal meshes (0 and -0 are told apart).
    pub fn checksum(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        let counts = [self.positions.len(), self.triangles.len()];
        hash.update(counts.map(|n| (n as u64).to_le_bytes()).as_flattened());
        hash.update(bytes_of(&self.positions));
        hash.update(bytes_of(&self.triangles));
        hash.update(bytes_of(self.masks().unwrap_or_default()));
        hash.digest()
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The three corners of a triangle.
    pub fn corners(&self, tri: TriId) -> [Vec3; 3] {
        self.triangles[tri.index()].map(|i| self.positions[i as usize])
    }

    /// The triangles with three different vertices. No ray hits the others, so structures leave them out.
    pub fn solid(&self) -> impl Iterator<Item = TriId> + '_ {
        self.solid_among(0..self.len())
    }

    /// Those of a range.
    pub(crate) fn solid_among(&self, ids: Range<usize>) -> impl Iterator<Item = TriId> + '_ {
        let solid = |[a, b, c]: &[u32; 3]| a != b && b != c && a != c;
        let triangles = (ids.start as u32..).zip(&self.triangles[ids]);
        triangles.filter(move |(_, triangle)| solid(triangle)).map(|(id, _)| TriId(id))
    }

    /// Something of each of them, in order; on several threads if it is to be.
    pub(crate) fn of_solid<T: Copy + Send + Sync>(
        &self,
        parallel: bool,
        make: impl Fn(TriId) -> T + Sync,
    ) -> Result<Vec<T>> {
        made(self.len(), CHUNK, parallel, "references", |range| self.solid_among(range).map(&make))
    }

    /// The box of all triangles; empty for the empty mesh. Vertices that no triangle uses don't count.
    pub fn bounds(&self) -> Aabb {
        self.bounds_of(&self.triangles)
    }

    /// The same, found by several threads if they are to.
    pub(crate) fn bounds_by(&self, parallel: bool) -> Aabb {
        if !parallel {
            return self.bounds();
        }
        // In the order of the triangles: which of two zeros counts does not depend on threads.
        let chunks: Vec<Aabb> = self.triangles.par_chunks(CHUNK).map(|triangles| self.bounds_of(triangles)).collect();
        chunks.iter().fold(Aabb::EMPTY, |all, chunk| all.union(chunk))
    }

    fn bounds_of(&self, triangles: &[[u32; 3]]) -> Aabb {
        triangles.as_flattened().iter().fold(Aabb::EMPTY, |b, &i| b.with(self.positions[i as usize]))
    }
}

fn limit(what: &'static str, count: usize, limit: usize) -> Result<()> {
    if count > limit { Err(Error::TooMany { what, count, limit }) } else { Ok(()) }
}
