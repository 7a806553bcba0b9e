//! The binary tree made of a kd-tree's: its splits are the nodes, and its cells the leaves, with the boxes of the triangles' parts in
//! them.
//!
//! A kd-tree may cut where an object split may not, and so separates what overlaps; boxes fit tighter than cells and hold no empty
//! space. Where a cut saves little, both parts go back to one side; what a cell has too much of, objects are split for.

use super::binary::{BinaryNode, DEEPEST, grow_below, halvings};
use super::extent::Extent;
use super::grown::{Grown, Parts};
use super::split::{Search, tests};
use crate::clip::TriangleClipper;
use crate::error::Result;
use crate::geom::Aabb;
use crate::heuristic::Heuristic;
use crate::kd::branch::{Branch, Branches};
use crate::kd::stop::usual_depth;
use crate::kd::{self, KdSpec, Reference};
use crate::mem::reserve;
use crate::options::{BuildOptions, Watch};
use crate::simd::Portable;

/// What the kd-tree is built from.
pub(crate) struct Cells<'a> {
    pub(crate) clipper: &'a TriangleClipper<'a>,
    pub(crate) bounds: Aabb,
    pub(crate) spec: KdSpec,
    pub(crate) heuristic: &'a dyn Heuristic,
    /// The most references.
    pub(crate) most: usize,
}

/// Larger subtrees are converted on two threads if there are.
const OWN_ABOVE: usize = 1 << 12;

/// Parts are joined in cells that have so few references together: in those that budgets have left large it would take too long.
const FEW: usize = 64;

/// Grows a kd-tree and makes a tree of boxes of it.
pub(crate) fn grow(cells: &Cells<'_>, search: Search, options: &BuildOptions<'_>) -> Result<Grown> {
    // A cell that is still too large must fit into the depth that is left.
    let depth = DEEPEST - halvings(cells.most, search.leaf);
    let max_depth = depth.min(usual_depth(cells.spec.stop, cells.clipper.mesh.len()) as u32) as usize;
    let limited = BuildOptions { max_depth: Some(max_depth), ..*options };
    let Cells { clipper, bounds, ref spec, heuristic, most } = *cells;
    let branches: Branches<Reference> = kd::grow(clipper, bounds, spec, heuristic, most, &limited)?;
    // The kd-tree has reported all progress there is.
    let silent = BuildOptions { progress: None, ..*options };
    let watch = Watch::new(&silent, most);
    let counts = counts(&branches)?;
    let converter = Converter { branches: &branches, counts, search, watch: &watch };
    let root = branches.nodes.len() - 1;
    if converter.counts[root] == 0 {
        return Ok(Grown::default());
    }
    converter.convert(root, 0)?.1.join(search.parallel)
}

/// How many references lie below each node: children come before their parents.
fn counts(branches: &Branches<Reference>) -> Result<Vec<u32>> {
    let mut counts: Vec<u32> = Vec::new();
    reserve(&mut counts, branches.nodes.len(), "counts of references")?;
    for node in &branches.nodes {
        counts.push(match *node {
            Branch::Leaf { count, .. } => count,
            Branch::Interior { children: [l, r], .. } => counts[l as usize] + counts[r as usize],
        });
    }
    Ok(counts)
}

struct Converter<'a> {
    branches: &'a Branches<Reference>,
    counts: Vec<u32>,
    search: Search,
    watch: &'a Watch<'a>,
}

impl Converter<'_> {
    /// Large subtrees: both sides on their own, then joined. Returns the subtree's box, too.
    fn convert(&self, branch: usize, depth: u32) -> Result<(Extent, Parts)> {
        match self.sides(branch) {
            Some([l, r]) if self.counts[branch] as usize > OWN_ABOVE => {
                self.watch.check_cancelled()?;
                let (left, right) = (|| self.convert(l, depth + 1), || self.convert(r, depth + 1));
                let (left, right) = self.search.both(left, right);
                let ((mut extent, left), (high, right)) = (left?, right?);
                extent.grow::<Portable>(&high);
                Ok((extent, Parts::over(extent, left, right)?))
            }
            _ => {
                let mut grown = Grown::default();
                let extent = self.convert_in(&mut grown, branch, depth)?;
                Ok((extent, grown.into()))
            }
        }
    }

    /// The two sides of a node on which there is something; where only one has, those of that. Nothing for a leaf.
    fn sides(&self, mut branch: usize) -> Option<[usize; 2]> {
        loop {
            let Branch::Interior { children, .. } = self.branches.nodes[branch] else { return None };
            let [l, r] = children.map(|child| child as usize);
            match (self.counts[l], self.counts[r]) {
                (0, _) => branch = r,
                (_, 0) => branch = l,
                _ => return Some([l, r]),
            }
        }
    }

    /// Small subtrees: one thread, one list. Returns the subtree's box.
    fn convert_in(&self, grown: &mut Grown, branch: usize, depth: u32) -> Result<Extent> {
        let Some([l, r]) = self.sides(branch) else {
            return self.add(grown, &mut self.references(branch)?, depth);
        };
        self.watch.check_at(branch)?;
        let pair = match (self.sides(l), self.sides(r)) {
            (None, None) => {
                let (mut low, mut high) = (self.references(l)?, self.references(r)?);
                if low.len() + high.len() <= FEW {
                    reunite(&mut low, &mut high);
                }
                Some((low, high))
            }
            _ => None,
        };
        if let Some((low, high)) = &pair
            && (low.is_empty() || high.is_empty())
        {
            let mut all = [&low[..], &high[..]].concat();
            return self.add(grown, &mut all, depth);
        }
        let place = grown.nodes.len();
        reserve(&mut grown.nodes, 1, "nodes")?;
        grown.nodes.push(BinaryNode::interior(Extent::EMPTY, 0));
        let (mut extent, right, high) = match pair {
            Some((mut low, mut high)) => {
                let extent = self.add(grown, &mut low, depth + 1)?;
                (extent, grown.nodes.len() as u32, self.add(grown, &mut high, depth + 1)?)
            }
            None => {
                let extent = self.convert_in(grown, l, depth + 1)?;
                (extent, grown.nodes.len() as u32, self.convert_in(grown, r, depth + 1)?)
            }
        };
        extent.grow::<Portable>(&high);
        grown.nodes[place] = BinaryNode::interior(extent, right);
        Ok(extent)
    }

    /// Adds a cell, split further by objects if it has many.
    fn add(&self, grown: &mut Grown, references: &mut [Extent], depth: u32) -> Result<Extent> {
        let extent = grow_below(&mut grown.nodes, references, grown.ids.len(), depth, self.search, self.watch)?;
        reserve(&mut grown.ids, references.len(), "references")?;
        grown.ids.extend(references.iter().map(|r| r.link));
        Ok(extent)
    }

    /// The references of a leaf, or of the one leaf below a node that has any.
    fn references(&self, mut branch: usize) -> Result<Vec<Extent>> {
        let range = loop {
            match self.branches.nodes[branch] {
                Branch::Leaf { first, count } => break first as usize..(first + count) as usize,
                Branch::Interior { children: [l, r], .. } => {
                    branch = if self.counts[l as usize] > 0 { l as usize } else { r as usize };
                }
            }
        };
        let mut references = Vec::new();
        reserve(&mut references, range.len(), "references")?;
        references.extend(self.branches.kept[range].iter().map(|r| Extent::new(&r.bounds(), r.id, 0)));
        Ok(references)
    }
}

/// Joins the parts of primitives that lie in two neighbouring cells, on one side, where that is cheaper. O(n²) a part.
fn reunite(low: &mut Vec<Extent>, high: &mut Vec<Extent>) {
    let mut i = 0;
    while i < low.len() {
        let Some(j) = high.iter().position(|part| part.link == low[i].link) else {
            i += 1;
            continue;
        };
        match cheapest(low, high, i, j) {
            Place::Both => i += 1,
            Place::Left => {
                let part = high.swap_remove(j);
                low[i] = whole(&low[i], &part);
                i += 1;
            }
            Place::Right => {
                let part = low.swap_remove(i);
                high[j] = whole(&high[j], &part);
            }
        }
    }
}

enum Place {
    Both,
    Left,
    Right,
}

/// Two parts of a primitive as one.
fn whole(a: &Extent, b: &Extent) -> Extent {
    let mut both = *a;
    both.grow::<Portable>(b);
    both.with(a.link, 0)
}

/// Where a primitive had better be, of which element `i` of the left and element `j` of the right references are parts.
fn cheapest(low: &[Extent], high: &[Extent], i: usize, j: usize) -> Place {
    let cost = |side: &[Extent], without: Option<usize>, more: Option<&Extent>| {
        let kept = side.iter().enumerate().filter(|(k, _)| Some(*k) != without).map(|(_, part)| part);
        let n = side.len() as u32 - u32::from(without.is_some());
        let mut union = more.copied().unwrap_or(Extent::EMPTY);
        kept.for_each(|part| union.grow::<Portable>(part));
        if n == 0 { 0.0 } else { union.half_area() * tests(n) }
    };
    let both = cost(low, None, None) + cost(high, None, None);
    let left = cost(low, None, Some(&high[j])) + cost(high, Some(j), None);
    let right = cost(low, Some(i), None) + cost(high, None, Some(&low[i]));
    if both <= left && both <= right {
        Place::Both
    } else if left <= right {
        Place::Left
    } else {
        Place::Right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(id: u32, from: f32, to: f32) -> Extent {
        Extent::new(&Aabb { min: [from, 0.0, 0.0], max: [to, 1.0, 1.0] }, id, 0)
    }

    #[test]
    fn a_sliver_goes_back_to_its_primitive_and_halves_stay_apart() {
        let others = |from: f32, first: u32| (first..first + 4).map(move |id| part(id, from, from + 1.0));
        let (mut low, mut high): (Vec<_>, Vec<_>) = (others(0.0, 10).collect(), others(1.0, 20).collect());
        low.push(part(1, 0.0, 1.0));
        high.extend([part(1, 1.0, 1.01), part(2, 1.0, 2.0)]);
        low.push(part(2, 0.0, 1.0));
        reunite(&mut low, &mut high);
        let find = |side: &[Extent], id: u32| side.iter().find(|e| e.link == id).map(|e| e.bounds().max[0]);
        assert_eq!((find(&low, 1), find(&high, 1)), (Some(1.01), None));
        assert_eq!((find(&low, 2), find(&high, 2)), (Some(1.0), Some(2.0)));
        assert_eq!((low.len(), high.len()), (6, 5));
    }
}
