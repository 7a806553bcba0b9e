//! Giving equal corners one index.

use std::collections::HashMap;

use crate::error::Result;
use crate::formats::assemble::Part;
use crate::formats::grow;

/// A part that grows by triangles given by their corners.
#[derive(Debug, Default)]
pub(super) struct Weld {
    part: Part,
    /// Only looked up, never walked through: its order is random.
    vertices: HashMap<[u64; 3], u32>,
}

impl Weld {
    pub(super) fn new(name: String) -> Self {
        Self { part: Part { name, ..Part::default() }, vertices: HashMap::new() }
    }

    /// Adds a triangle.
    pub(super) fn triangle(&mut self, corners: [[f64; 3]; 3]) -> Result<()> {
        let [a, b, c] = corners.map(|p| self.vertex(p));
        grow::push(&mut self.part.triangles, [a?, b?, c?])
    }

    /// How many triangles there are.
    pub(super) fn len(&self) -> usize {
        self.part.triangles.len()
    }

    pub(super) fn finish(self) -> Part {
        self.part
    }

    fn vertex(&mut self, position: [f64; 3]) -> Result<u32> {
        let positions = &mut self.part.positions;
        // A u32 is enough: a corner takes at least 12 bytes, and `assemble` checks the total.
        let next = positions.len() as u32;
        let index = *self.vertices.entry(position.map(f64::to_bits)).or_insert(next);
        if index == next {
            grow::push(positions, position)?;
        }
        Ok(index)
    }
}
