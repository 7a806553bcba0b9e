//! A binary tree that has grown in parts, and its joining into one list.
//!
//! Large subtrees grow on several threads, each in a list of its own. Joined two by two, a node would be copied once for each level
//! above its part; so parts stay apart until all are there, and are copied once.

use super::binary::BinaryNode;
use super::extent::Extent;
use crate::error::{Error, Result};
use crate::mem::joined;

/// A tree over references, and their ids in the order of its leaves; or a part of one, whose nodes count from its own beginning.
#[derive(Default)]
pub(crate) struct Grown {
    pub(crate) nodes: Vec<BinaryNode>,
    /// None where the order of what it was built over says it.
    pub(crate) ids: Vec<u32>,
}

/// The parts of a tree, whose nodes are in preorder from one to the next.
pub(crate) struct Parts(Vec<Grown>);

impl From<Grown> for Parts {
    fn from(part: Grown) -> Self {
        Self(vec![part])
    }
}

impl Parts {
    /// More nodes than links can name are no tree.
    const MOST: usize = u32::MAX as usize / 2;

    /// A node over two subtrees.
    pub(crate) fn over(extent: Extent, left: Self, right: Self) -> Result<Self> {
        let of_left = left.len();
        if of_left + right.len() >= Self::MOST {
            return Err(Error::OverBudget { what: "nodes", limit: Self::MOST });
        }
        let node = BinaryNode::interior(extent, 1 + of_left as u32);
        let mut parts = vec![Grown { nodes: vec![node], ids: Vec::new() }];
        parts.extend(left.0);
        parts.extend(right.0);
        Ok(Self(parts))
    }

    fn len(&self) -> usize {
        self.0.iter().map(|part| part.nodes.len()).sum()
    }

    /// The whole tree.
    pub(crate) fn join(mut self, parallel: bool) -> Result<Grown> {
        if let [_] = self.0[..] {
            return Ok(self.0.pop().unwrap_or_default());
        }
        let (mut starts, mut nodes, mut ids) = (Vec::new(), 0, 0);
        for part in &self.0 {
            starts.push((nodes, ids));
            (nodes, ids) = (nodes + part.nodes.len() as u32, ids + part.ids.len() as u32);
        }
        let (lists, of_ids): (Vec<_>, Vec<_>) = self.0.iter().map(|part| (&part.nodes[..], &part.ids[..])).unzip();
        let nodes = joined(&lists, parallel, "nodes", |part, node: BinaryNode| {
            let (nodes, references) = starts[part];
            node.after(nodes, references)
        })?;
        Ok(Grown { nodes, ids: joined(&of_ids, parallel, "references", |_, id| id)? })
    }
}
