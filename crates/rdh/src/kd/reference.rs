//! What the builder moves about: the box of a triangle's part in a cell.

use crate::clip::Slice;
use crate::geom::{Aabb, Axis, Vec3};
use crate::simd::Four;

/// A reference to a primitive: the box of its part in the cell, and its id. 32 bytes, one vector load.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Reference {
    /// Lower corner.
    pub min: Vec3,
    /// Which primitive.
    pub id: u32,
    /// Upper corner.
    pub max: Vec3,
    /// Not used; keeps the record at 32 bytes.
    pub unused: u32,
}

impl Reference {
    /// A reference to a whole primitive, or to its part in a box.
    #[inline(always)]
    pub fn new(id: u32, bounds: &Aabb) -> Self {
        Self { min: bounds.min, id, max: bounds.max, unused: 0 }
    }

    /// The box of the part.
    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.min, max: self.max }
    }

    /// The same in lanes.
    #[inline(always)]
    pub(crate) fn slice(&self) -> Slice {
        let [a, b, c, d, e, f, g, h]: [f32; 8] = bytemuck::cast(*self);
        Slice { min: Four::new([a, b, c, d]), max: Four::new([e, f, g, h]) }
    }

    /// Where it lies with respect to a split plane. THE classification: candidates and partition agree by using it.
    /// What lies flat in the plane goes left or right as the split says.
    #[inline(always)]
    pub(crate) fn sides(&self, axis: Axis, plane: f32, flat_left: bool) -> (bool, bool) {
        let (low, high) = (self.min[axis.index()], self.max[axis.index()]);
        let (left, right) = (low < plane, high > plane);
        // On neither side: flat.
        if left || right { (left, right) } else { (flat_left, !flat_left) }
    }
}
