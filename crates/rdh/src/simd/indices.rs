//! Eight triangles that lie in a mesh: where their corners are, instead of copies.

use super::{Block, LANES, Lanes};
use crate::geom::TriId;
use crate::mesh::Mesh;

/// For eight triangles the vertices at their corners, lane by lane, and their ids: two cache lines, where copies take five.
///
/// Unused lanes repeat a real triangle.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Indices {
    /// `corners[corner][lane]`, indices of vertices.
    pub(crate) corners: [[u32; LANES]; 3],
    /// Triangle ids.
    pub(crate) ids: [u32; LANES],
}

impl Indices {
    /// Copies the triangles out of the mesh's vertices. The plain loop that every instruction set agrees with.
    ///
    /// # Panics
    /// If a vertex is out of range.
    #[inline(always)]
    pub(crate) fn copy_to(&self, points: &[[f32; 3]], block: &mut Block) {
        for (c, corner) in self.corners.iter().enumerate() {
            for (lane, &vertex) in corner.iter().enumerate() {
                let point = points[vertex as usize];
                for (a, x) in point.into_iter().enumerate() {
                    block.corners[c][a][lane] = x;
                }
            }
        }
        block.ids = self.ids;
    }
}

impl Lanes for Indices {
    fn put(&mut self, lane: usize, id: u32, mesh: &Mesh) {
        for (c, vertex) in mesh.triangles()[id as usize].into_iter().enumerate() {
            self.corners[c][lane] = vertex;
        }
        self.ids[lane] = id;
    }

    fn ids(&self) -> &[u32; LANES] {
        &self.ids
    }

    fn is_faithful(&self, lane: usize, tri: TriId, mesh: &Mesh) -> bool {
        self.corners.map(|corner| corner[lane]) == mesh.triangles()[tri.index()]
    }
}

#[cfg(test)]
mod tests {
    use bytemuck::Zeroable;

    use super::*;
    use crate::geom::Vec3;
    use crate::simd::{Job, Kernels, Level};

    struct Gather<'a>(&'a [Vec3], &'a Indices);

    impl Job for Gather<'_> {
        type Output = Block;

        #[inline(always)]
        fn run<K: Kernels>(self) -> Block {
            let mut block = Block::zeroed();
            K::gather(self.0, self.1, &mut block);
            block
        }
    }

    fn blocks(points: u32, indices: &Indices) -> Vec<Block> {
        let points: Vec<Vec3> = (0..points).map(|i| [i as f32, -(i as f32), 0.5 * i as f32]).collect();
        Level::available().into_iter().map(|level| level.run(Gather(&points, indices))).collect()
    }

    /// Up to the very last vertex, behind which nothing may be read.
    #[test]
    fn all_levels_gather_the_same() {
        for points in [1, 2, 3, 24, 100] {
            for first in 0..points {
                let corners =
                    std::array::from_fn(|c| std::array::from_fn(|lane| (first + 8 * c as u32 + lane as u32) % points));
                let indices = Indices { corners, ids: std::array::from_fn(|lane| lane as u32 + 7) };
                let blocks = blocks(points, &indices);
                assert!(blocks.iter().all(|block| *block == blocks[0]));
                let x = corners[1][3] as f32;
                assert_eq!((blocks[0].corners(3)[1], blocks[0].ids[3]), ([x, -x, 0.5 * x], 10));
            }
        }
    }

    #[test]
    #[should_panic(expected = "index out of bounds")]
    fn what_is_out_of_range_is_not_read() {
        blocks(30, &Indices { corners: [[0; LANES], [0; LANES], [30; LANES]], ids: [0; LANES] });
    }
}
