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

use super::binary::BinaryNode;
use crate::error::Result;
use crate::mem::reserve;
use crate::options::Watch;
use crate::simd::LANES;

/// What a wide tree costs: a visit of a node, and a test of eight triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Costs {
    pub(crate) node: f32,
    pub(crate) test: f32,
}

/// The way to cut a binary tree into wide nodes of up to `W` children.
pub(crate) struct Cuts<const W: usize> {
    cuts: Vec<Cut<W>>,
    /// How many references each subtree has.
    counts: Vec<u32>,
}

/// How a subtree is cut, for each number of roots.
#[derive(Debug, Clone, Copy)]
struct Cut<const W: usize> {
    /// For up to k roots (element k − 1): how many of them go to the left child; 0: it stays whole.
    left: [u8; W],
    /// Whether it becomes one leaf if it stays whole.
    leaf: bool,
}

impl<const W: usize> Cuts<W> {
    /// The cheapest cuts of all subtrees. `visits` gives the weight of each node. O(N W²).
    pub(crate) fn cheapest(
        nodes: &[BinaryNode],
        costs: Costs,
        visits: impl Fn(usize) -> f32,
        watch: &Watch<'_>,
    ) -> Result<Self> {
        let (mut cuts, mut forests, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        reserve(&mut cuts, nodes.len(), "cuts")?;
        reserve(&mut forests, nodes.len(), "cuts")?;
        reserve(&mut counts, nodes.len(), "cuts")?;
        cuts.resize(nodes.len(), Cut { left: [0; W], leaf: true });
        forests.resize(nodes.len(), [0.0f32; W]);
        counts.resize(nodes.len(), 0u32);
        // In preorder children come after their parents: backwards they are done first.
        for (i, node) in nodes.iter().enumerate().rev() {
            watch.check_at(i)?;
            let weight = visits(i);
            let test = weight * costs.test;
            if !node.is_interior() {
                counts[i] = node.0.count;
                forests[i] = [test * node.0.count.div_ceil(LANES as u32) as f32; W];
                continue;
            }
            let (l, r) = (i + 1, node.right());
            counts[i] = counts[l].saturating_add(counts[r]);
            let (parts, lefts) = share(&forests[l], &forests[r]);
            let whole = weight * costs.node + parts[W - 1];
            let leaf = counts[i] as usize <= LANES && test <= whole;
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
            (forests[i], cuts[i]) = (forest, Cut { left, leaf });
        }
        Ok(Self { cuts, counts })
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
            let left = usize::from(self.cuts[node].left[k - 1]);
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
        self.counts[node]
    }

    /// Whether a node that stays whole becomes a leaf.
    pub(crate) fn is_leaf(&self, nodes: &[BinaryNode], node: usize) -> bool {
        !nodes[node].is_interior() || self.cuts[node].leaf
    }
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
