//! Looking at a finished tree node by node: for pictures and studies. Rays go another way (`trace.rs`).

use super::KdTree;
use super::node::NodeKind;
use crate::geom::{Aabb, Axis};

/// A node as it is shown, in the mesh's space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown<'a> {
    /// A split of the node's cell.
    Interior {
        /// Which axis is split.
        axis: Axis,
        /// Where.
        plane: f32,
    },
    /// A leaf.
    Leaf {
        /// Its triangles.
        triangles: &'a [u32],
    },
}

impl KdTree {
    /// Visits all nodes, each before its children and the left child before the right one: cell, depth, node.
    pub fn walk(&self, visit: &mut dyn FnMut(&Aabb, usize, Shown<'_>)) {
        let mut ids = Vec::new();
        let mut todo = vec![(self.root, self.bounds, 0)];
        while let Some((node, cell, depth)) = todo.pop() {
            let world = self.scale.unscaled(&cell);
            match node.kind() {
                NodeKind::Interior { axis, split, pair } => {
                    let (left, right) = cell.split(axis, split);
                    let [l, r] = self.pairs()[pair as usize];
                    todo.extend([(r, right, depth + 1), (l, left, depth + 1)]);
                    visit(&world, depth, Shown::Interior { axis, plane: split / self.scale.factor() });
                }
                NodeKind::Leaf { block, lane, count } => {
                    ids.clear();
                    let lanes = self.blocks[block as usize..].iter().flat_map(|b| b.ids);
                    ids.extend(lanes.skip(lane as usize).take(count as usize));
                    visit(&world, depth, Shown::Leaf { triangles: &ids });
                }
            }
        }
    }

    /// Visits all leaves, left to right: cell, depth, triangles.
    pub fn cells(&self, visit: &mut dyn FnMut(Aabb, usize, &[u32])) {
        self.walk(&mut |cell, depth, node| {
            if let Shown::Leaf { triangles } = node {
                visit(*cell, depth, triangles);
            }
        });
    }
}
