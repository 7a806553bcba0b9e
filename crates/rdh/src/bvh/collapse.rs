//! From a binary tree to wide nodes: which of its nodes become children of one, by dynamic programming.
//!
//! Wald, Benthin and Boulos, *Getting Rid of Packets* (2008) open the largest child greedily; here, as in Ylitalo, Karras and Laine,
//! *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (HPG 2017, section 3), the cheapest way is found:
//! ```text
//! forest(n, k): the cheapest way to cut the subtree of n into at most k roots
//! forest(n, 1) = min(leaf, visits(n) · c_node + parts(n, W))
//! forest(n, k) = min(forest(n, k − 1), parts(n, k))                         k = 2 … W − 1
//! parts(n, k)  = min over i of forest(left, i) + forest(right, k − i)
//! leaf         = visits(n) · c_test, if one test of eight does
//! ```
//! `visits` are areas, or the measured visits of a profile.

use rayon::prelude::*;

use super::binary::{BinaryNode, subtrees};
use crate::error::Result;
use crate::mem::zeroed;
use crate::options::Watch;
use crate::simd::LANES;

/// What a wide tree costs: a visit of a node, and a test of eight triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Costs {
    pub(crate) node: f32,
    pub(crate) test: f32,
}

/// The way to cut a binary tree into wide nodes of up to `W` children.
pub(crate) struct Cuts<const W: usize>(Vec<Cut<W>>);

/// How a subtree is cut, for each number of roots.
#[derive(Debug, Clone, Copy, bytemuck::Zeroable)]
struct Cut<const W: usize> {
    /// What it costs as up to k roots (element k − 1).
    forest: [f32; W],
    /// For up to k roots (element k − 1): how many of them go to the left child; 0: it stays whole.
    left: [u8; W],
    /// Whether it becomes one leaf if it stays whole.
    leaf: bool,
    /// How many references it has.
    count: u32,
}

/// Subtrees of so many nodes are cut by one thread each.
const AT_ONCE: usize = 1 << 11;

impl<const W: usize> Cuts<W> {
    /// The cheapest cuts of all subtrees. `visits` gives the weight of each node. Where some primitives may have several references,
    /// `repeated` has their ids, of which a leaf needs each but once. O(N W²).
    pub(crate) fn cheapest(
        nodes: &[BinaryNode],
        repeated: Option<&[u32]>,
        costs: Costs,
        visits: impl Fn(usize) -> f32 + Sync,
        parallel: bool,
        watch: &Watch<'_>,
    ) -> Result<Self> {
        let mut cuts: Vec<Cut<W>> = zeroed(nodes.len(), "cuts")?;
        let (above, below) = subtrees(nodes, AT_ONCE);
        let (mut pieces, mut rest, mut done) = (Vec::with_capacity(below.len()), &mut cuts[..], 0);
        for subtree in below {
            let (piece, after) = rest[subtree.start - done..].split_at_mut(subtree.len());
            (rest, done) = (after, subtree.end);
            pieces.push((subtree.start, piece));
        }
        let once = |node: usize, references: u32| match repeated {
            Some(ids) if (LANES + 1..=2 * LANES).contains(&(references as usize)) => {
                distinct(nodes, ids, node).unwrap_or(references)
            }
            _ => references,
        };
        // In preorder children come after their parents: backwards they are done first.
        let cut_all = |(first, cuts): (usize, &mut [Cut<W>])| {
            for i in (0..cuts.len()).rev() {
                let node = first + i;
                watch.check_at(node)?;
                let below = |child: usize| &cuts[child - first];
                let children = || [below(node + 1), below(nodes[node].right())];
                cuts[i] = Cut::of(&nodes[node], visits(node), costs, children, |n| once(node, n));
            }
            Ok(())
        };
        if parallel {
            pieces.into_par_iter().try_for_each(cut_all)?;
        } else {
            pieces.into_iter().try_for_each(cut_all)?;
        }
        for &node in above.iter().rev() {
            let children = || [&cuts[node + 1], &cuts[nodes[node].right()]];
            cuts[node] = Cut::of(&nodes[node], visits(node), costs, children, |n| once(node, n));
        }
        Ok(Self(cuts))
    }

    /// The binary nodes that become the children of a wide node made of `node`, in order.
    pub(crate) fn children(&self, nodes: &[BinaryNode], node: usize) -> ([usize; W], usize) {
        let (mut children, mut n) = ([0; W], 0);
        let (mut todo, mut waiting) = ([(0, 0); W], 1);
        todo[0] = (node, W);
        let mut first = true;
        while waiting > 0 {
            waiting -= 1;
            let (node, k) = todo[waiting];
            let left = usize::from(self.0[node].left[k - 1]);
            if !nodes[node].is_interior() || (!first && (k == 1 || left == 0)) {
                children[n] = node;
                n += 1;
                continue;
            }
            first = false;
            todo[waiting] = (nodes[node].right(), k - left);
            todo[waiting + 1] = (node + 1, left);
            waiting += 2;
        }
        (children, n)
    }

    /// The references below a node.
    pub(crate) fn count(&self, node: usize) -> u32 {
        self.0[node].count
    }

    /// Whether a node that stays whole becomes a leaf.
    pub(crate) fn is_leaf(&self, nodes: &[BinaryNode], node: usize) -> bool {
        !nodes[node].is_interior() || self.0[node].leaf
    }
}

impl<const W: usize> Cut<W> {
    /// How a node is cut that is visited with some weight; asks for its children's cuts if it has some, and how many references are left
    /// if each primitive has one alone.
    #[inline(always)]
    fn of<'a>(
        node: &BinaryNode,
        weight: f32,
        costs: Costs,
        children: impl FnOnce() -> [&'a Self; 2],
        once: impl FnOnce(u32) -> u32,
    ) -> Self {
        let test = weight * costs.test;
        if !node.is_interior() {
            let count = node.0.count;
            return Self { forest: [test * count.div_ceil(LANES as u32) as f32; W], left: [0; W], leaf: true, count };
        }
        let [l, r] = children();
        let count = once(l.count.saturating_add(r.count));
        let (parts, lefts) = share(&l.forest, &r.forest);
        let whole = weight * costs.node + parts[W - 1];
        let leaf = count as usize <= LANES && test <= whole;
        let (mut forest, mut left) = ([if leaf { test } else { whole }; W], [0; W]);
        left[W - 1] = lefts[W - 1];
        for k in 1..W - 1 {
            (forest[k], left[k]) = (forest[k - 1], 0);
            if parts[k] < forest[k] {
                (forest[k], left[k]) = (parts[k], lefts[k]);
            } else if left[k - 1] != 0 {
                // As with one root fewer.
                left[k] = left[k - 1];
            }
        }
        Self { forest, left, leaf, count }
    }
}

/// How many primitives a subtree has, if one test is enough for them; else nothing.
fn distinct(nodes: &[BinaryNode], ids: &[u32], node: usize) -> Option<u32> {
    let (mut found, mut n) = ([0; LANES], 0);
    // In preorder a subtree ends where no child is left to come.
    let mut to_come = 1;
    for node in &nodes[node..] {
        if node.is_interior() {
            to_come += 1;
            continue;
        }
        for id in &ids[node.range()] {
            if !found[..n].contains(id) {
                *found.get_mut(n)? = *id;
                n += 1;
            }
        }
        to_come -= 1;
        if to_come == 0 {
            break;
        }
    }
    Some(n as u32)
}

/// The cheapest ways to share k roots among two children, k = 2 … W at element k − 1; and what the left one gets.
#[inline(always)]
fn share<const W: usize>(left: &[f32; W], right: &[f32; W]) -> ([f32; W], [u8; W]) {
    let (mut parts, mut lefts) = ([f32::INFINITY; W], [0; W]);
    for k in 2..=W {
        for i in 1..k {
            let cost = left[i - 1] + right[k - i - 1];
            if cost < parts[k - 1] {
                (parts[k - 1], lefts[k - 1]) = (cost, i as u8);
            }
        }
    }
    (parts, lefts)
}

#[cfg(test)]
mod tests {
    use super::super::extent::Extent;
    use super::*;

    #[test]
    fn a_primitive_counts_once_in_a_leaf() {
        let leaf = |first, count| BinaryNode::leaf(Extent::EMPTY, first, count);
        let nodes = [BinaryNode::interior(Extent::EMPTY, 2), leaf(0, 5), leaf(5, 5), leaf(10, 1)];
        assert_eq!(distinct(&nodes, &[1, 2, 3, 4, 5, 5, 4, 3, 2, 6, 7], 0), Some(6));
        assert_eq!(distinct(&nodes, &[1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 9], 0), Some(8));
        assert_eq!(distinct(&nodes, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2], 0), None);
    }
}
