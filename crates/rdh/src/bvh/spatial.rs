//! The binary tree with spatial splits: where the boxes of both sides would overlap, primitives are cut instead.
//!
//! Stich, Friedrich and Dietrich, *Spatial Splits in Bounding Volume Hierarchies* (HPG 2009): chopped binning (section 4.1), the test
//! for overlap (4.3) and reference unsplitting (4.4). Each subtree has its share of spare references, so that memory is bounded and
//! the tree is the same on any number of threads.
//!
//! A reference is a box that holds the part of a primitive in it; the parts of a primitive together are all of it.

use super::binary::{BinaryNode, DEEPEST, halvings};
use super::chop::{Chop, SpatialSplit};
use super::extent::Extent;
use super::grown::{Grown, Parts};
use super::split::{Centres, Search, Split};
use crate::clip::Clipper;
use crate::error::Result;
use crate::mem::reserve;
use crate::options::Watch;

/// Overlaps below this part of the whole structure's area are not worth a cut.
const LEAST_OVERLAP: f32 = 1e-5;
/// Larger subtrees grow on two threads if there are.
const OWN_ABOVE: usize = 1 << 12;

/// Grows a tree over references, of which cuts may add `spare`.
pub(crate) fn grow(
    references: Vec<Extent>,
    clipper: &impl Clipper,
    search: Search,
    spare: usize,
    watch: &Watch<'_>,
) -> Result<Grown> {
    let (extent, centres) = search.measure(&references);
    let grower = Grower { clipper, search, watch, least_overlap: extent.half_area() * LEAST_OVERLAP };
    grower.grow(references, Todo { extent, centres, depth: 0, spare })?.join(search.parallel)
}

struct Grower<'a, C> {
    clipper: &'a C,
    search: Search,
    watch: &'a Watch<'a>,
    least_overlap: f32,
}

/// A node to be built.
struct Todo {
    extent: Extent,
    centres: Centres,
    depth: u32,
    spare: usize,
}

/// One side of a split.
type Side = (Vec<Extent>, Todo);

impl<C: Clipper> Grower<'_, C> {
    /// Large subtrees: both sides on their own, then joined.
    fn grow(&self, references: Vec<Extent>, todo: Todo) -> Result<Parts> {
        if references.len() <= OWN_ABOVE {
            let mut grown = Grown::default();
            self.grow_in(&mut grown, references, todo)?;
            return Ok(grown.into());
        }
        self.watch.check_cancelled()?;
        let extent = todo.extent;
        let [(low, todo_low), (high, todo_high)] = self.part(references, todo)?;
        let (left, right) = (|| self.grow(low, todo_low), || self.grow(high, todo_high));
        let (left, right) = self.search.both(left, right);
        Parts::over(extent, left?, right?)
    }

    /// Small subtrees: one thread, one list.
    fn grow_in(&self, grown: &mut Grown, references: Vec<Extent>, todo: Todo) -> Result<()> {
        let n = references.len();
        reserve(&mut grown.nodes, 1, "nodes")?;
        if n <= self.search.leaf {
            self.watch.report(n);
            grown.nodes.push(BinaryNode::leaf(todo.extent, grown.ids.len(), n));
            reserve(&mut grown.ids, n, "references")?;
            grown.ids.extend(references.iter().map(|r| r.link));
            return Ok(());
        }
        if n > 1024 {
            self.watch.check_cancelled()?;
        }
        let (place, extent) = (grown.nodes.len(), todo.extent);
        grown.nodes.push(BinaryNode::interior(extent, 0));
        let [(low, todo_low), (high, todo_high)] = self.part(references, todo)?;
        self.grow_in(grown, low, todo_low)?;
        let right = grown.nodes.len() as u32;
        self.grow_in(grown, high, todo_high)?;
        grown.nodes[place] = BinaryNode::interior(extent, right);
        Ok(())
    }

    /// Parts a node's references by the cheaper kind of split.
    fn part(&self, references: Vec<Extent>, todo: Todo) -> Result<[Side; 2]> {
        let n = references.len();
        // Halving from here on must end within the depth that is left.
        if todo.depth + halvings(n, self.search.leaf) + 1 >= DEEPEST {
            return self.part_in_the_middle(references, &todo);
        }
        let object = self.search.best(&references, &todo.centres, Some(self.watch));
        self.check_between(n)?;
        if let Some(spatial) = self.spatial(&references, &todo, object.as_ref()) {
            self.check_between(n)?;
            let (left, right) = spatial.part(&references, self.clipper)?;
            // A cut that leaves all references on both sides gets nowhere. And bins only estimate how many it adds: planes and
            // bins may part references otherwise.
            let added = (left.len() + right.len()).saturating_sub(n);
            let parts = !left.is_empty() && !right.is_empty() && left.len().max(right.len()) < n;
            if parts && added <= todo.spare {
                return Ok(self.sides(left, right, &todo, n));
            }
        }
        match object {
            Some(split) => self.part_at(references, &split, &todo),
            None => self.part_in_the_middle(references, &todo),
        }
    }

    /// Asks whether to go on between the steps of a large node.
    fn check_between(&self, n: usize) -> Result<()> {
        if n > OWN_ABOVE { self.watch.check_cancelled() } else { Ok(()) }
    }

    /// A spatial split, if the boxes of an object split overlap, it is cheaper, and there are references to spare.
    fn spatial(&self, references: &[Extent], todo: &Todo, object: Option<&Split>) -> Option<SpatialSplit> {
        if todo.spare == 0 || object.is_some_and(|split| !self.overlaps(split)) {
            return None;
        }
        let cost = object.map_or(f32::INFINITY, |split| split.cost);
        let chop = Chop { references, extent: &todo.extent, clipper: self.clipper };
        chop.best(&self.search).filter(|split| split.cost < cost && split.added(references.len()) <= todo.spare)
    }

    fn overlaps(&self, split: &Split) -> bool {
        let both = split.left.bounds().intersection(&split.right.bounds());
        !both.is_empty() && Extent::new(&both, 0, 0).half_area() >= self.least_overlap
    }

    fn part_at(&self, mut references: Vec<Extent>, split: &Split, todo: &Todo) -> Result<[Side; 2]> {
        let (left, _) = self.search.part(&mut references, split);
        self.part_after(references, left, todo)
    }

    /// Whole blocks on the left.
    fn part_in_the_middle(&self, references: Vec<Extent>, todo: &Todo) -> Result<[Side; 2]> {
        let left = (references.len() / 2).next_multiple_of(self.search.leaf).min(references.len() - 1);
        self.part_after(references, left, todo)
    }

    fn part_after(&self, mut references: Vec<Extent>, left: usize, todo: &Todo) -> Result<[Side; 2]> {
        let n = references.len();
        let mut right = Vec::new();
        reserve(&mut right, n - left, "references")?;
        right.extend_from_slice(&references[left..]);
        references.truncate(left);
        Ok(self.sides(references, right, todo, n))
    }

    /// What both sides are to become, with their shares of the references to spare.
    fn sides(&self, left: Vec<Extent>, right: Vec<Extent>, todo: &Todo, n: usize) -> [Side; 2] {
        let total = left.len() + right.len();
        let spare = todo.spare - (total - n);
        let of_left = (spare as u128 * left.len() as u128 / total as u128) as usize;
        [(left, of_left), (right, spare - of_left)].map(|(side, spare)| {
            let (extent, centres) = self.search.measure(&side);
            (side, Todo { extent, centres, depth: todo.depth + 1, spare })
        })
    }
}
