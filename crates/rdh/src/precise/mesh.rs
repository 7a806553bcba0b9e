//! Meshes with vertices in f64.

use crate::error::{Error, Result};
use crate::geom::TriId;
use crate::mem::Array;
use crate::mesh::Mesh;

/// A triangle mesh with vertices in f64: finite, indices in range, at most 2³⁰ triangles. Clones share their memory.
#[derive(Debug, Clone, Default)]
pub struct MeshF64 {
    positions: Array<[f64; 3]>,
    triangles: Array<[u32; 3]>,
    masks: Option<Array<u32>>,
    /// The largest size of a coordinate of a triangle.
    reach: f64,
}

impl MeshF64 {
    /// Checks vertices and indices, in O(n).
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::IndexOutOfRange`] or [`Error::TooMany`], naming the first culprit.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        Mesh::check_size(positions.len(), triangles.len())?;
        for (vertex, p) in positions.iter().enumerate() {
            if let Some(axis) = p.iter().position(|x| !x.is_finite()) {
                // What is not finite is the same in f32.
                return Err(Error::NotFinite { vertex, axis, value: p[axis] as f32 });
            }
        }
        Mesh::check_indices(&triangles, positions.len())?;
        let coordinates = triangles.as_flattened().iter().flat_map(|&i| positions[i as usize]);
        let reach = coordinates.fold(0.0, |reach: f64, x| reach.max(x.abs()));
        Ok(Self { positions: positions.into(), triangles: triangles.into(), masks: None, reach })
    }

    /// Gives each triangle a mask; a ray sees it when `ray.mask & mask != 0`. The default is all ones.
    ///
    /// # Errors
    /// [`Error::WrongLength`] unless there is one mask a triangle.
    pub fn with_masks(mut self, masks: Vec<u32>) -> Result<Self> {
        if masks.len() != self.triangles.len() {
            return Err(Error::WrongLength { what: "masks", got: masks.len(), expected: self.triangles.len() });
        }
        self.masks = Some(masks.into());
        Ok(self)
    }

    /// The vertices.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The triangles, three vertex indices each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangles, to be held.
    pub(super) fn triangle_array(&self) -> Array<[u32; 3]> {
        self.triangles.clone()
    }

    /// The masks, where there are any.
    pub fn masks(&self) -> Option<&[u32]> {
        self.masks.as_deref()
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
    pub fn corners(&self, tri: TriId) -> [[f64; 3]; 3] {
        self.triangles[tri.index()].map(|i| self.positions[i as usize])
    }

    /// The largest size of a coordinate of a triangle.
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether a ray with this mask sees a triangle.
    pub(super) fn is_seen(&self, tri: TriId, mask: u32) -> bool {
        self.masks().is_none_or(|masks| masks[tri.index()] & mask != 0)
    }
}
