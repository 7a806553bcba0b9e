//! The binary tree that all wide trees are made of: top-down, greedy, O(N log N), parallel, the same on any number of threads.
//!
//! ```text
//! grow(primitives):
//!     leaf, if there are few enough
//!     split = the cheapest plane between bins; the middle, if centres coincide or the tree would get too deep   (split.rs)
//!     part the primitives in place, grow both sides
//! ```
//! Invariant: the builder sees boxes, never a mesh.

use std::ops::Range;

use super::extent::Extent;
use super::grown::{Grown, Parts};
use super::split::{Asked, Centres, Search, Split};
use crate::error::Result;
use crate::mem::reserve;
use crate::options::Watch;

/// A node of a binary tree in preorder: a node's left child is the next one, its right child comes after the left one's
/// subtree. A box, and in its payload for an interior node 0 and the right child, for a leaf how many primitives it has and
/// which is the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BinaryNode(pub(crate) Extent);

impl BinaryNode {
    /// A leaf over a range of primitives, not an empty one.
    #[inline(always)]
    pub(crate) fn leaf(extent: Extent, first: usize, count: usize) -> Self {
        Self(extent.with(first as u32, count as u32))
    }

    /// An interior node.
    #[inline(always)]
    pub(crate) fn interior(extent: Extent, right: u32) -> Self {
        Self(extent.with(right, 0))
    }

    /// Whether it has children.
    #[inline(always)]
    pub(crate) fn is_interior(&self) -> bool {
        self.0.count == 0
    }

    /// A leaf's range of primitives.
    #[inline(always)]
    pub(crate) fn range(&self) -> Range<usize> {
        let first = self.0.link as usize;
        first..first + self.0.count as usize
    }

    /// An interior node's right child.
    #[inline(always)]
    pub(crate) fn right(&self) -> usize {
        self.0.link as usize
    }

    /// The same node in a list where so many nodes come before those of its own, and primitives before its own.
    #[inline(always)]
    pub(crate) fn after(self, nodes: u32, primitives: u32) -> Self {
        let more = if self.is_interior() { nodes } else { primitives };
        Self(self.0.with(self.0.link + more, self.0.count))
    }
}

/// Subtrees of at most so many nodes, in order, and the nodes above them: what several threads share out, the same for any number.
pub(crate) fn subtrees(nodes: &[BinaryNode], most: usize) -> (Vec<usize>, Vec<Range<usize>>) {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    let mut todo = Vec::new();
    todo.push(0..nodes.len());
    while let Some(subtree) = todo.pop() {
        let root = subtree.start;
        if subtree.len() <= most || !nodes[root].is_interior() {
            below.push(subtree);
            continue;
        }
        above.push(root);
        let right = nodes[root].right();
        todo.extend([right..subtree.end, root + 1..right]);
    }
    (above, below)
}

/// The deepest that a binary tree gets, in edges.
pub(crate) const DEEPEST: u32 = 64;
/// Larger subtrees grow in a list of their own, on two threads if there are.
const OWN_ABOVE: usize = 1 << 12;

/// Chooses where to split: by areas, or by the rays in a node.
pub(crate) trait Chooser: Sync {
    /// The rays in a node, as far as they matter.
    type Rays: Send;

    /// The rays in the root.
    fn root(&self, extent: &Extent) -> Self::Rays;

    /// Those of a node's rays that meet a child.
    fn descend(&self, rays: &Self::Rays, child: &Extent) -> Self::Rays;

    /// The cheapest split of a node, unless all centres coincide.
    fn best(&self, search: &Search, primitives: &[Extent], node: &Node<Self::Rays>, asked: Asked<'_>) -> Option<Split>;
}

/// Splits by areas.
pub(crate) struct ByArea;

impl Chooser for ByArea {
    type Rays = ();

    fn root(&self, _extent: &Extent) {}

    fn descend(&self, (): &(), _child: &Extent) {}

    fn best(&self, search: &Search, primitives: &[Extent], node: &Node<()>, asked: Asked<'_>) -> Option<Split> {
        search.best(primitives, &node.centres, asked)
    }
}

/// Grows a tree over primitives, whose order changes.
pub(crate) fn grow<C: Chooser>(
    primitives: &mut [Extent],
    search: Search,
    chooser: &C,
    watch: &Watch<'_>,
) -> Result<Vec<BinaryNode>> {
    let (extent, centres) = search.measure(primitives);
    let rays = chooser.root(&extent);
    let parts = Grower { search, chooser, watch }.grow(primitives, 0, Node { extent, centres, depth: 0, rays })?;
    Ok(parts.join(search.parallel)?.nodes)
}

/// Adds a subtree by areas to a list; `first` is the place of the first primitive. It lies so deep that there is room below it for
/// halving the primitives down to leaves.
pub(crate) fn grow_below(
    nodes: &mut Vec<BinaryNode>,
    primitives: &mut [Extent],
    first: usize,
    depth: u32,
    search: Search,
    watch: &Watch<'_>,
) -> Result<Extent> {
    let (extent, centres) = search.measure(primitives);
    let grower = Grower { search, chooser: &ByArea, watch };
    grower.grow_in(nodes, primitives, first, Node { extent, centres, depth, rays: () })?;
    Ok(extent)
}

/// How often `n` primitives are halved until leaves of `leaf` are left.
pub(crate) fn halvings(n: usize, leaf: usize) -> u32 {
    n.div_ceil(leaf).next_power_of_two().trailing_zeros()
}

/// What stays the same for all nodes.
struct Grower<'a, C> {
    search: Search,
    chooser: &'a C,
    watch: &'a Watch<'a>,
}

/// A node to be built.
pub(crate) struct Node<R> {
    pub(crate) extent: Extent,
    pub(crate) centres: Centres,
    pub(crate) depth: u32,
    pub(crate) rays: R,
}

impl<C: Chooser> Grower<'_, C> {
    /// Large subtrees: both sides in lists of their own, then joined. `first` is the place of the first primitive.
    fn grow(&self, primitives: &mut [Extent], first: usize, todo: Node<C::Rays>) -> Result<Parts> {
        let n = primitives.len();
        if n <= OWN_ABOVE {
            let mut nodes = Vec::new();
            // Leaves are half full on average.
            reserve(&mut nodes, 4 * n / self.search.leaf + 1, "nodes")?;
            self.grow_in(&mut nodes, primitives, first, todo)?;
            return Ok(Grown { nodes, ids: Vec::new() }.into());
        }
        self.watch.check_cancelled()?;
        let (left, [todo_left, todo_right]) = self.part(primitives, &todo);
        let (low, high) = primitives.split_at_mut(left);
        let grow_left = || self.grow(low, first, todo_left);
        let grow_right = || self.grow(high, first + left, todo_right);
        let (l, r) = self.search.both(grow_left, grow_right);
        Parts::over(todo.extent, l?, r?)
    }

    /// Small subtrees: one thread, one list.
    fn grow_in(
        &self,
        nodes: &mut Vec<BinaryNode>,
        primitives: &mut [Extent],
        first: usize,
        todo: Node<C::Rays>,
    ) -> Result<()> {
        let n = primitives.len();
        if n <= self.search.leaf {
            self.watch.report(n);
            reserve(nodes, 1, "nodes")?;
            nodes.push(BinaryNode::leaf(todo.extent, first, n));
            return Ok(());
        }
        if n > 1024 {
            self.watch.check_cancelled()?;
        }
        let (left, [todo_left, todo_right]) = self.part(primitives, &todo);
        let (low, high) = primitives.split_at_mut(left);
        let place = nodes.len();
        reserve(nodes, 1, "nodes")?;
        nodes.push(BinaryNode::interior(todo.extent, 0));
        self.grow_in(nodes, low, first, todo_left)?;
        let right = nodes.len() as u32;
        self.grow_in(nodes, high, first + left, todo_right)?;
        nodes[place] = BinaryNode::interior(todo.extent, right);
        Ok(())
    }

    /// Parts a node's primitives: how many are on the left, and what both sides are to become.
    fn part(&self, primitives: &mut [Extent], todo: &Node<C::Rays>) -> (usize, [Node<C::Rays>; 2]) {
        // Halving from here on must end within the depth that is left.
        let has_room = todo.depth + halvings(primitives.len(), self.search.leaf) < DEEPEST;
        let split = if has_room { self.chooser.best(&self.search, primitives, todo, Some(self.watch)) } else { None };
        match split {
            Some(split) => self.part_at(primitives, &split, todo),
            None => self.part_in_the_middle(primitives, todo),
        }
    }

    fn part_at(&self, primitives: &mut [Extent], split: &Split, todo: &Node<C::Rays>) -> (usize, [Node<C::Rays>; 2]) {
        let (left, centres) = self.search.part(primitives, split);
        let [low, high] = centres;
        (left, [self.child(todo, split.left, low), self.child(todo, split.right, high)])
    }

    /// Whole blocks on the left.
    fn part_in_the_middle(&self, primitives: &mut [Extent], todo: &Node<C::Rays>) -> (usize, [Node<C::Rays>; 2]) {
        let left = (primitives.len() / 2).next_multiple_of(self.search.leaf).min(primitives.len() - 1);
        let side = |primitives: &[Extent]| {
            let (extent, centres) = self.search.measure(primitives);
            self.child(todo, extent, centres)
        };
        (left, [side(&primitives[..left]), side(&primitives[left..])])
    }

    fn child(&self, todo: &Node<C::Rays>, extent: Extent, centres: Centres) -> Node<C::Rays> {
        let rays = self.chooser.descend(&todo.rays, &extent);
        Node { extent, centres, depth: todo.depth + 1, rays }
    }
}
