//! The tree while it grows: nodes in the order in which they are finished, children before parents.

use super::node::Node;
use crate::error::{Error, Result};
use crate::geom::Axis;
use crate::mem::reserve;

/// A growing tree, or a part of one.
#[derive(Debug, Default)]
pub(crate) struct Branches {
    pub(crate) nodes: Vec<Branch>,
    /// The leaves' primitives.
    pub(crate) ids: Vec<u32>,
}

/// A node of a growing tree.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Branch {
    /// A split, with its two children and the chances to visit them.
    Interior { axis: Axis, plane: f32, children: [u32; 2], chances: [f32; 2] },
    /// A range of `ids`.
    Leaf { first: u32, count: u32 },
}

/// A state of [`Branches`] to fall back to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mark {
    nodes: usize,
    ids: usize,
}

impl Branches {
    pub(crate) fn mark(&self) -> Mark {
        Mark { nodes: self.nodes.len(), ids: self.ids.len() }
    }

    /// Adds a leaf.
    pub(crate) fn leaf(&mut self, ids: impl ExactSizeIterator<Item = u32>) -> Result<u32> {
        let (first, count) = (self.ids.len() as u32, ids.len() as u32);
        Self::limit("triangles of a leaf", ids.len(), Node::MAX_COUNT as usize)?;
        Self::limit("references", self.ids.len() + ids.len(), u32::MAX as usize)?;
        reserve(&mut self.ids, ids.len(), "leaf references")?;
        self.ids.extend(ids);
        self.push(Branch::Leaf { first, count })
    }

    /// Adds a node.
    pub(crate) fn push(&mut self, branch: Branch) -> Result<u32> {
        Self::limit("nodes", self.nodes.len() + 1, u32::MAX as usize)?;
        reserve(&mut self.nodes, 1, "nodes")?;
        self.nodes.push(branch);
        Ok(self.nodes.len() as u32 - 1)
    }

    /// Indices have 32 bits, and a leaf's count has 28.
    fn limit(what: &'static str, count: usize, limit: usize) -> Result<()> {
        if count > limit { Err(Error::OverBudget { what, limit }) } else { Ok(()) }
    }

    /// Replaces all nodes since `mark` by one leaf with all their primitives, each once; returns it and their number.
    pub(crate) fn collapse(&mut self, mark: Mark) -> Result<(u32, usize)> {
        self.nodes.truncate(mark.nodes);
        self.ids[mark.ids..].sort_unstable();
        let mut kept = mark.ids;
        for i in mark.ids..self.ids.len() {
            if i == mark.ids || self.ids[i] != self.ids[i - 1] {
                self.ids[kept] = self.ids[i];
                kept += 1;
            }
        }
        self.ids.truncate(kept);
        let count = kept - mark.ids;
        let leaf = self.push(Branch::Leaf { first: mark.ids as u32, count: count as u32 })?;
        Ok((leaf, count))
    }

    /// How many nodes there are in each subtree: at its root, the last of them.
    pub(crate) fn sizes(&self) -> Result<Vec<u32>> {
        let mut sizes: Vec<u32> = Vec::new();
        reserve(&mut sizes, self.nodes.len(), "nodes")?;
        for branch in &self.nodes {
            sizes.push(match branch {
                Branch::Leaf { .. } => 1,
                Branch::Interior { children: [a, b], .. } => 1 + sizes[*a as usize] + sizes[*b as usize],
            });
        }
        Ok(sizes)
    }

    /// Adds another part's nodes; returns by how much their indices have grown.
    pub(crate) fn append(&mut self, other: &Self) -> Result<u32> {
        Self::limit("nodes", self.nodes.len() + other.nodes.len(), u32::MAX as usize)?;
        Self::limit("references", self.ids.len() + other.ids.len(), u32::MAX as usize)?;
        let (shift, ids) = (self.nodes.len() as u32, self.ids.len() as u32);
        reserve(&mut self.nodes, other.nodes.len(), "nodes")?;
        reserve(&mut self.ids, other.ids.len(), "leaf references")?;
        self.ids.extend_from_slice(&other.ids);
        self.nodes.extend(other.nodes.iter().map(|&b| match b {
            Branch::Leaf { first, count } => Branch::Leaf { first: first + ids, count },
            Branch::Interior { axis, plane, children, chances } => {
                Branch::Interior { axis, plane, children: children.map(|c| c + shift), chances }
            }
        }));
        Ok(shift)
    }
}
