//! Meshes out of anything: what is wrong with them is left out, and listed.

use crate::error::Result;
use crate::geom::{TriId, Vec3};
use crate::mesh::Mesh;

/// What [`Mesh::sanitised`] found wrong.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Wrong {
    /// Triangles that no ray hits: those with an index out of range, or with a vertex that is not finite.
    pub triangles: Vec<TriId>,
    /// Vertices with a coordinate that is not finite, whether used or not.
    pub vertices: Vec<u32>,
}

impl Wrong {
    /// Whether nothing was.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.vertices.is_empty()
    }
}

impl Mesh {
    /// A mesh out of any bit patterns. Triangles that can't be used stay in their places, so that all others keep their ids, but
    /// are shrunk to a point: no structure refers to them, and no ray hits them. O(n).
    ///
    /// # Errors
    /// [`Error::TooMany`](crate::Error::TooMany).
    pub fn sanitised(mut positions: Vec<Vec3>, mut triangles: Vec<[u32; 3]>) -> Result<(Self, Wrong)> {
        let is_finite = |p: &Vec3| p.iter().all(|x| x.is_finite());
        let is_usable = |t: &[u32; 3]| t.iter().all(|&i| positions.get(i as usize).is_some_and(is_finite));
        let place = triangles.iter().find(|t| is_usable(t)).map(|t| t[0]);
        let wrong = Wrong {
            triangles: ids(triangles.iter().map(|t| !is_usable(t))).map(TriId).collect(),
            vertices: ids(positions.iter().map(|p| !is_finite(p))).collect(),
        };
        // A place that is in the way of nothing: a corner of the first good triangle.
        let (place, point) = match place {
            Some(vertex) => (vertex, positions[vertex as usize]),
            None => (0, [0.0; 3]),
        };
        if positions.is_empty() && !wrong.triangles.is_empty() {
            positions.push(point);
        }
        wrong.vertices.iter().for_each(|&vertex| positions[vertex as usize] = point);
        wrong.triangles.iter().for_each(|tri| triangles[tri.index()] = [place; 3]);
        Ok((Self::new(positions, triangles)?, wrong))
    }
}

/// Where it is true.
fn ids(flags: impl Iterator<Item = bool>) -> impl Iterator<Item = u32> {
    (0..).zip(flags).filter(|(_, flag)| *flag).map(|(id, _)| id)
}
