//! What leaves hold: copies of triangles, or where the triangles are in the mesh.

use crate::geom::Vec3;
use crate::mem::Array;
use crate::mesh::Mesh;
use crate::simd::{Block, Indices, Kernels, Lanes, prefetch};

/// What walks ask of blocks of eight triangles.
pub(crate) trait Corners {
    /// The corners of a block's triangles, copied to `scratch` if need be.
    fn corners<'b, K: Kernels>(&'b self, block: usize, scratch: &'b mut Block) -> &'b Block;

    /// Asks for a block that will be needed soon.
    fn prefetch(&self, block: usize);
}

/// Blocks of eight triangles, in one form or another.
pub(crate) trait Leaves: Corners + Clone {
    /// A block.
    type Block: Lanes;

    /// Blocks of triangles of a mesh.
    fn new(blocks: Array<Self::Block>, mesh: &Mesh) -> Self;

    /// All blocks.
    fn blocks(&self) -> &Array<Self::Block>;

    /// Bytes that are needed beside the blocks.
    fn other_bytes(&self) -> usize;

    /// The same memory as one of all forms.
    fn any(&self) -> AnyLeaves;
}

/// Blocks in any form: which one is asked at each leaf. For walks of many rays at a time, where that costs nothing beside the rest and
/// a walk for each form would be much code.
#[derive(Debug, Clone)]
pub(crate) enum AnyLeaves {
    Copies(Copies),
    Shared(Shared),
}

impl Corners for AnyLeaves {
    #[inline(always)]
    fn corners<'b, K: Kernels>(&'b self, block: usize, scratch: &'b mut Block) -> &'b Block {
        match self {
            Self::Copies(copies) => copies.corners::<K>(block, scratch),
            Self::Shared(shared) => shared.corners::<K>(block, scratch),
        }
    }

    #[inline(always)]
    fn prefetch(&self, block: usize) {
        match self {
            Self::Copies(copies) => copies.prefetch(block),
            Self::Shared(shared) => shared.prefetch(block),
        }
    }
}

/// Copies of triangles: 40 bytes each and more, five cache lines for eight.
#[derive(Debug, Clone)]
pub struct Copies(Array<Block>);

impl Corners for Copies {
    #[inline(always)]
    fn corners<'b, K: Kernels>(&'b self, block: usize, _scratch: &'b mut Block) -> &'b Block {
        &self.0[block]
    }

    #[inline(always)]
    fn prefetch(&self, block: usize) {
        prefetch(&self.0[block]);
    }
}

impl Leaves for Copies {
    type Block = Block;

    fn new(blocks: Array<Block>, _mesh: &Mesh) -> Self {
        Self(blocks)
    }

    fn blocks(&self) -> &Array<Block> {
        &self.0
    }

    fn other_bytes(&self) -> usize {
        0
    }

    fn any(&self) -> AnyLeaves {
        AnyLeaves::Copies(self.clone())
    }
}

/// Indices into the mesh's vertices: 16 bytes a triangle and more, and the vertices themselves. Memory is saved, but the vertices have
/// to be fetched and put in order whenever a ray comes by.
#[derive(Debug, Clone)]
pub struct Shared {
    blocks: Array<Indices>,
    points: Array<Vec3>,
}

impl Corners for Shared {
    #[inline(always)]
    fn corners<'b, K: Kernels>(&'b self, block: usize, scratch: &'b mut Block) -> &'b Block {
        K::gather(&self.points, &self.blocks[block], scratch);
        scratch
    }

    #[inline(always)]
    fn prefetch(&self, block: usize) {
        prefetch(&self.blocks[block]);
    }
}

impl Leaves for Shared {
    type Block = Indices;

    fn new(blocks: Array<Indices>, mesh: &Mesh) -> Self {
        Self { blocks, points: mesh.position_array() }
    }

    fn blocks(&self) -> &Array<Indices> {
        &self.blocks
    }

    fn other_bytes(&self) -> usize {
        size_of_val(&self.points[..])
    }

    fn any(&self) -> AnyLeaves {
        AnyLeaves::Shared(self.clone())
    }
}
