//! Eight triangles side by side, as leaves hold them.

use crate::geom::{TriId, Vec3};
use crate::mem::Plain;
use crate::mesh::Mesh;

/// Triangles in a block.
pub(crate) const LANES: usize = 8;

/// Eight triangles of a mesh, in any form that leaves hold.
pub(crate) trait Lanes: Plain + bytemuck::Zeroable {
    /// Writes a triangle into a lane.
    fn put(&mut self, lane: usize, id: u32, mesh: &Mesh);

    /// The triangles' ids.
    fn ids(&self) -> &[u32; LANES];

    /// Whether a lane says of a triangle what the mesh says.
    fn is_faithful(&self, lane: usize, tri: TriId, mesh: &Mesh) -> bool;
}

/// The corners of eight triangles, lane by lane, and their ids: five cache lines.
///
/// Unused lanes repeat a real triangle, so that they need no special care.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// `corners[corner][axis][lane]`.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
    /// Triangle ids.
    pub(crate) ids: [u32; LANES],
}

impl Block {
    /// Writes a triangle into a lane.
    pub(crate) fn set(&mut self, lane: usize, corners: &[Vec3; 3], id: u32) {
        for (c, corner) in corners.iter().enumerate() {
            for (a, &x) in corner.iter().enumerate() {
                self.corners[c][a][lane] = x;
            }
        }
        self.ids[lane] = id;
    }

    /// The corners of the triangle in a lane, along some order of the axes.
    #[inline(always)]
    pub(crate) fn corners_along(&self, lane: usize, [kx, ky, kz]: [usize; 3]) -> [Vec3; 3] {
        let ([a, b, c], (kx, ky, kz), lane) = (&self.corners, (kx.min(2), ky.min(2), kz.min(2)), lane & (LANES - 1));
        [
            [a[kx][lane], a[ky][lane], a[kz][lane]],
            [b[kx][lane], b[ky][lane], b[kz][lane]],
            [c[kx][lane], c[ky][lane], c[kz][lane]],
        ]
    }

    /// The corners of the triangle in a lane.
    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [Vec3; 3] {
        let c = &self.corners;
        [
            [c[0][0][lane], c[0][1][lane], c[0][2][lane]],
            [c[1][0][lane], c[1][1][lane], c[1][2][lane]],
            [c[2][0][lane], c[2][1][lane], c[2][2][lane]],
        ]
    }
}

impl Lanes for Block {
    fn put(&mut self, lane: usize, id: u32, mesh: &Mesh) {
        self.set(lane, &mesh.corners(TriId(id)), id);
    }

    fn ids(&self) -> &[u32; LANES] {
        &self.ids
    }

    /// Bit for bit.
    fn is_faithful(&self, lane: usize, tri: TriId, mesh: &Mesh) -> bool {
        let bits = |corners: [Vec3; 3]| corners.map(|c| c.map(f32::to_bits));
        bits(self.corners(lane)) == bits(mesh.corners(tri))
    }
}
