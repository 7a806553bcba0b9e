//! The tree while it grows: nodes in the order in which they are finished, children before parents.

use super::node::Node;
use super::reference::Reference;
use crate::error::{Error, Result};
use crate::geom::Axis;
use crate::mem::reserve;

/// A growing tree, or a part of one.
#[derive(Debug)]
pub(crate) struct Branches<K = u32> {
    pub(crate) nodes: Vec<Branch>,
    /// What is kept of the leaves' references.
    pub(crate) kept: Vec<K>,
}

impl<K> Default for Branches<K> {
    fn default() -> Self {
        Self { nodes: Vec::new(), kept: Vec::new() }
    }
}

/// What a leaf keeps of a reference: a kd-tree the primitive's id, a hierarchy that is made of its cells all of it.
pub(crate) trait Kept: Copy + Send {
    fn of(reference: &Reference) -> Self;

    fn id(&self) -> u32;

    /// Two parts of one primitive as one.
    fn with(self, other: &Self) -> Self;
}

impl Kept for u32 {
    fn of(reference: &Reference) -> Self {
        reference.id
    }

    fn id(&self) -> u32 {
        *self
    }

    fn with(self, _: &Self) -> Self {
        self
    }
}

impl Kept for Reference {
    fn of(reference: &Reference) -> Self {
        *reference
    }

    fn id(&self) -> u32 {
        self.id
    }

    fn with(self, other: &Self) -> Self {
        Self::new(self.id, &self.bounds().union(&other.bounds()))
    }
}

/// A node of a growing tree.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Branch {
    /// A split, with its two children and the chances to visit them.
    Interior { axis: Axis, plane: f32, children: [u32; 2], chances: [f32; 2] },
    /// A range of what is kept.
    Leaf { first: u32, count: u32 },
}

/// A state of [`Branches`] to fall back to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mark {
    nodes: usize,
    kept: usize,
}

impl<K: Kept> Branches<K> {
    pub(crate) fn mark(&self) -> Mark {
        Mark { nodes: self.nodes.len(), kept: self.kept.len() }
    }

    /// Adds a leaf.
    pub(crate) fn leaf(&mut self, refs: &[Reference]) -> Result<u32> {
        let (first, count) = (self.kept.len() as u32, refs.len() as u32);
        Self::limit("triangles of a leaf", refs.len(), Node::MAX_COUNT as usize)?;
        Self::limit("references", self.kept.len() + refs.len(), u32::MAX as usize)?;
        reserve(&mut self.kept, refs.len(), "leaf references")?;
        self.kept.extend(refs.iter().map(K::of));
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

    /// Replaces all nodes since `mark` by one leaf with all their primitives, the parts of each as one; returns it and their number.
    pub(crate) fn collapse(&mut self, mark: Mark) -> Result<(u32, usize)> {
        self.nodes.truncate(mark.nodes);
        let kept = &mut self.kept[mark.kept..];
        kept.sort_unstable_by_key(K::id);
        let mut count = 0;
        for i in 0..kept.len() {
            if count > 0 && kept[i].id() == kept[count - 1].id() {
                kept[count - 1] = kept[count - 1].with(&kept[i]);
            } else {
                kept[count] = kept[i];
                count += 1;
            }
        }
        self.kept.truncate(mark.kept + count);
        let leaf = self.push(Branch::Leaf { first: mark.kept as u32, count: count as u32 })?;
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
        Self::limit("references", self.kept.len() + other.kept.len(), u32::MAX as usize)?;
        let (shift, kept) = (self.nodes.len() as u32, self.kept.len() as u32);
        reserve(&mut self.nodes, other.nodes.len(), "nodes")?;
        reserve(&mut self.kept, other.kept.len(), "leaf references")?;
        self.kept.extend_from_slice(&other.kept);
        self.nodes.extend(other.nodes.iter().map(|&b| match b {
            Branch::Leaf { first, count } => Branch::Leaf { first: first + kept, count },
            Branch::Interior { axis, plane, children, chances } => {
                Branch::Interior { axis, plane, children: children.map(|c| c + shift), chances }
            }
        }));
        Ok(shift)
    }
}
