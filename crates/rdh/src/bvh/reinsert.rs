//! Moves subtrees to where they make the tree cheaper: what top-down building could not see.
//!
//! Meister and Bittner, *Parallel Reinsertion for Bounding Volume Hierarchies Optimization* (EG 2018): for many subtrees at once, the
//! best new place is searched by branch and bound (section 4.1); of moves that touch the same nodes, the one that gains most wins
//! (4.2). Cost is the sum of the interior nodes' areas. The same on any number of threads.

use rayon::prelude::*;

use super::binary::{BinaryNode, DEEPEST};
use super::crowd::Crowd;
use super::extent::Extent;
use crate::error::Result;
use crate::heuristic::Rdh;
use crate::mem::reserve;
use crate::options::Watch;
use crate::simd::Portable;

/// Rounds of search and moves.
pub(crate) const ROUNDS: usize = 8;
/// Of all nodes, the largest are searched a place for: one in so many.
const SHARE: usize = 4;
/// Below nodes that fewer sampled rays visit nothing is moved for their sake.
const FEW: usize = 4;
/// Nodes whose areas one thread adds up.
const CHUNK: usize = 1 << 13;
/// Nodes that one thread searches a place for at once.
const SEARCHED: usize = 256;
/// What lies so far below the root, or deeper, is shared out among threads.
const SHARED_BELOW: u32 = 8;

/// A tree of the same leaves that costs less, or the same tree. O(rounds · N · nodes searched).
pub(crate) fn reinsert(nodes: Vec<BinaryNode>, parallel: bool, watch: &Watch<'_>) -> Result<Vec<BinaryNode>> {
    if nodes.is_empty() {
        return Ok(nodes);
    }
    let mut tree = Tree::new(&nodes)?;
    let mut round = Round::new(nodes.len())?;
    let mut cost = tree.cost(parallel);
    for _ in 0..ROUNDS {
        watch.check_cancelled()?;
        if !tree.improve(None, &mut round, parallel, watch)? {
            break;
        }
        // Each move gains by itself; what several of them do to the same ancestors was not asked.
        let now = tree.cost(parallel);
        if now >= cost || tree.depth(parallel) > DEEPEST {
            tree.undo();
            break;
        }
        cost = now;
    }
    tree.in_preorder(&nodes)
}

/// A tree of the same leaves that sampled rays visit less, or the same tree; and the chances that a ray which meets the root visits each
/// node. Moves are found as above, but only those are made that pay for the rays.
pub(crate) fn reinsert_for(
    rdh: &Rdh,
    mut nodes: Vec<BinaryNode>,
    rounds: usize,
    parallel: bool,
    watch: &Watch<'_>,
) -> Result<(Vec<BinaryNode>, Vec<f32>)> {
    let mut crowd = Crowd::new(&nodes, rdh, watch)?;
    let mut round = Round::new(nodes.len())?;
    let mut cost = crowd.cost(&nodes);
    for _ in 0..rounds {
        watch.check_cancelled()?;
        let mut tree = Tree::new(&nodes)?;
        if !tree.improve(Some(&crowd), &mut round, parallel, watch)? || tree.depth(parallel) > DEEPEST {
            break;
        }
        let moved = tree.in_preorder(&nodes)?;
        let now = Crowd::new(&moved, rdh, watch)?;
        let cost_now = now.cost(&moved);
        if cost_now >= cost {
            break;
        }
        (nodes, crowd, cost) = (moved, now, cost_now);
    }
    Ok((nodes, crowd.into_chances()))
}

/// The tree while nodes move about: node 0 is the root.
pub(crate) struct Tree {
    extents: Vec<Extent>,
    links: Vec<Links>,
    /// What the nodes that this round has changed were before, in the order of the changes.
    changes: Vec<Change>,
}

/// A node as it was.
struct Change {
    node: u32,
    extent: Extent,
    links: Links,
}

#[derive(Clone, Copy)]
struct Links {
    parent: u32,
    /// Of an interior node; both 0 for a leaf.
    children: [u32; 2],
}

/// A subtree, the node that is to become its sibling, and what that saves.
#[derive(Clone, Copy)]
pub(crate) struct Move {
    pub(crate) node: u32,
    pub(crate) to: u32,
    gain: f32,
}

impl Move {
    /// Moves that gain most come first, then those of nodes that lie first. For gains above 0, whose bits are in order.
    fn rank(&self) -> u64 {
        u64::from(!self.gain.to_bits()) << 32 | u64::from(self.node)
    }
}

/// A node that is searched a place for, in one number: the one with the largest box comes first, then the one that lies first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate(u64);

impl Candidate {
    fn new(node: u32, area: f32) -> Self {
        Self(u64::from(!area.to_bits()) << 32 | u64::from(node))
    }

    fn node(self) -> u32 {
        self.0 as u32
    }

    const BINS: usize = 1 << 12;

    /// By the sign, the exponent and three more bits.
    fn bin(self) -> usize {
        (self.0 >> 52) as usize
    }
}

/// What a round needs memory for.
struct Round {
    candidates: Vec<Candidate>,
    moves: Vec<Move>,
    /// The nodes that a move has changed or relied on.
    touched: Vec<bool>,
}

impl Round {
    fn new(n: usize) -> Result<Self> {
        let (mut candidates, mut touched) = (Vec::new(), Vec::new());
        reserve(&mut candidates, n, "nodes")?;
        reserve(&mut touched, n, "nodes")?;
        touched.resize(n, false);
        Ok(Self { candidates, moves: Vec::new(), touched })
    }
}

impl Tree {
    fn new(nodes: &[BinaryNode]) -> Result<Self> {
        let (mut extents, mut links) = (Vec::new(), Vec::new());
        reserve(&mut extents, nodes.len(), "nodes")?;
        reserve(&mut links, nodes.len(), "nodes")?;
        extents.extend(nodes.iter().map(|node| node.0));
        links.resize(nodes.len(), Links { parent: 0, children: [0; 2] });
        for (i, node) in nodes.iter().enumerate().filter(|(_, node)| node.is_interior()) {
            let children = [i + 1, node.right()];
            links[i].children = children.map(|c| c as u32);
            children.into_iter().for_each(|child| links[child].parent = i as u32);
        }
        Ok(Self { extents, links, changes: Vec::new() })
    }

    /// As it was before this round.
    fn undo(&mut self) {
        for Change { node, extent, links } in self.changes.drain(..).rev() {
            (self.extents[node as usize], self.links[node as usize]) = (extent, links);
        }
    }

    /// To be called before a node is changed.
    fn remember(&mut self, node: u32) -> Result<()> {
        reserve(&mut self.changes, 1, "changes")?;
        let (extent, links) = (self.extents[node as usize], self.links[node as usize]);
        self.changes.push(Change { node, extent, links });
        Ok(())
    }

    /// The sum of the interior nodes' half areas: chunk by chunk, so that it is the same on any number of threads.
    fn cost(&self, parallel: bool) -> f64 {
        let sum = |(links, extents): (&[Links], &[Extent])| -> f64 {
            let interiors = links.iter().zip(extents).filter(|(links, _)| links.children[0] != 0);
            interiors.map(|(_, extent)| f64::from(extent.half_area())).sum()
        };
        if parallel {
            let chunks = self.links.par_chunks(CHUNK).zip(self.extents.par_chunks(CHUNK));
            return chunks.map(sum).collect::<Vec<f64>>().iter().sum();
        }
        self.links.chunks(CHUNK).zip(self.extents.chunks(CHUNK)).map(sum).sum()
    }

    /// Searches and moves once, by areas or where it pays for a crowd of rays; whether anything moved.
    fn improve(
        &mut self,
        crowd: Option<&Crowd<'_>>,
        round: &mut Round,
        parallel: bool,
        watch: &Watch<'_>,
    ) -> Result<bool> {
        let Round { candidates, moves, touched } = round;
        self.choose_candidates(crowd, candidates, parallel);
        self.search(crowd, candidates, moves, parallel, watch)?;
        touched.fill(false);
        self.changes.clear();
        let mut any = false;
        for (i, step) in moves.iter().enumerate() {
            watch.check_at(i)?;
            let nodes = self.nodes_of(step);
            if nodes.iter().any(|&node| touched[node as usize]) || self.is_below(step.to, step.node) {
                continue;
            }
            nodes.iter().for_each(|&node| touched[node as usize] = true);
            self.apply(step)?;
            any = true;
        }
        Ok(any)
    }

    /// The candidates' best moves, as far as they gain: those that gain most come first.
    fn search(
        &self,
        crowd: Option<&Crowd<'_>>,
        candidates: &[Candidate],
        moves: &mut Vec<Move>,
        parallel: bool,
        watch: &Watch<'_>,
    ) -> Result<()> {
        let search = |candidates: &[Candidate]| {
            watch.check_cancelled()?;
            let (mut found, mut todo) = (Vec::new(), Vec::with_capacity(64));
            for candidate in candidates {
                let mut best = self.best_move(candidate.node(), &mut todo);
                if let Some(crowd) = crowd.filter(|_| self.is_worth_a_move(&best)) {
                    best.gain = crowd.gain(self, &best);
                }
                if self.is_worth_a_move(&best) {
                    reserve(&mut found, 1, "moves")?;
                    found.push(best);
                }
            }
            Ok(found)
        };
        let found: Result<Vec<Vec<Move>>> = if parallel {
            candidates.par_chunks(SEARCHED).map(search).collect()
        } else {
            candidates.chunks(SEARCHED).map(search).collect()
        };
        moves.clear();
        for mut found in found? {
            reserve(moves, found.len(), "moves")?;
            moves.append(&mut found);
        }
        // No two are equal: any sort gives the same.
        if parallel {
            moves.par_sort_unstable_by_key(Move::rank)
        } else {
            moves.sort_unstable_by_key(Move::rank)
        }
        Ok(())
    }

    /// Whether a move gains, and does more than to change places with the sibling.
    fn is_worth_a_move(&self, step: &Move) -> bool {
        step.gain > 0.0 && step.to != step.node && step.to != self.sibling(step.node)
    }

    /// The nodes with the largest boxes, but for the root and its children; or all whose parents are visited: what is moved away from there
    /// need not be visited itself.
    fn choose_candidates(&self, crowd: Option<&Crowd<'_>>, candidates: &mut Vec<Candidate>, parallel: bool) {
        let candidate = |node: u32| {
            let is_visited = crowd.is_none_or(|crowd| crowd.len(self.parent(node)) >= FEW);
            (self.parent(node) != 0 && is_visited).then(|| Candidate::new(node, self.area(node)))
        };
        let all_that = |is_wanted: &(dyn Fn(Candidate) -> bool + Sync), candidates: &mut Vec<Candidate>| {
            let nodes = 1..self.links.len() as u32;
            let candidate = |node| candidate(node).filter(|&candidate| is_wanted(candidate));
            candidates.clear();
            if parallel {
                candidates.par_extend(nodes.into_par_iter().filter_map(candidate));
            } else {
                candidates.extend(nodes.filter_map(candidate));
            }
        };
        if crowd.is_some() {
            return all_that(&|_| true, candidates);
        }
        // The last one of those that are wanted lies in this bin: only what is in it must be put in order.
        let bins = self.bins_of_candidates(&candidate, parallel);
        let most = bins.iter().sum::<usize>().div_ceil(SHARE);
        let (mut bin, mut before) = (0, 0);
        while bin + 1 < bins.len() && before + bins[bin] <= most {
            before += bins[bin];
            bin += 1;
        }
        all_that(&|candidate| candidate.bin() == bin, candidates);
        if most - before < candidates.len() {
            let (_, &mut limit, _) = candidates.select_nth_unstable(most - before);
            all_that(&|candidate| candidate < limit, candidates);
        } else {
            all_that(&|_| true, candidates);
        }
    }

    /// How many candidates fall into each bin.
    fn bins_of_candidates(&self, candidate: &(impl Fn(u32) -> Option<Candidate> + Sync), parallel: bool) -> Vec<usize> {
        let count = |first: u32| {
            let mut bins = vec![0; Candidate::BINS];
            let last = (first + CHUNK as u32).min(self.links.len() as u32);
            (first.max(1)..last).filter_map(candidate).for_each(|candidate| bins[candidate.bin()] += 1);
            bins
        };
        let merged = |mut a: Vec<usize>, b: Vec<usize>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let (firsts, none) = (0..self.links.len().div_ceil(CHUNK) as u32, || vec![0; Candidate::BINS]);
        if parallel {
            firsts.into_par_iter().map(|i| count(i * CHUNK as u32)).reduce(none, merged)
        } else {
            firsts.map(|i| count(i * CHUNK as u32)).fold(none(), merged)
        }
    }

    /// The lowest node above both ends of a move.
    pub(crate) fn meeting(&self, step: &Move) -> u32 {
        let mut above = Vec::with_capacity(DEEPEST as usize);
        let mut node = step.node;
        while node != 0 {
            node = self.parent(node);
            above.push(node);
        }
        let mut top = step.to;
        while !above.contains(&top) {
            top = self.parent(top);
        }
        top
    }

    /// Of all nodes but the root, which is its own.
    pub(crate) fn parent(&self, node: u32) -> u32 {
        self.links[node as usize].parent
    }

    /// A node's box.
    pub(crate) fn extent(&self, node: u32) -> Extent {
        self.extents[node as usize]
    }

    /// Half of a node's surface.
    pub(crate) fn area(&self, node: u32) -> f32 {
        self.extents[node as usize].half_area()
    }

    fn area_with(&self, node: u32, other: &Extent) -> f32 {
        let mut both = *other;
        both.grow::<Portable>(&self.extents[node as usize]);
        both.half_area()
    }

    /// The other child of a node's parent.
    pub(crate) fn sibling(&self, node: u32) -> u32 {
        let [a, b] = self.links[self.links[node as usize].parent as usize].children;
        if a == node { b } else { a }
    }

    /// The best new place of a subtree, or none that gains. Goes up from it; from each ancestor down the other side, as long as a gain is possible.
    fn best_move(&self, node: u32, todo: &mut Vec<(f32, u32)>) -> Move {
        let extent = &self.extents[node as usize];
        let (area, parent) = (extent.half_area(), self.links[node as usize].parent);
        let mut best = Move { node, to: node, gain: 0.0 };
        // What leaving saves: the parent goes, the ancestors up to the pivot shrink.
        let mut saved = self.area(parent);
        let (mut pivot, mut side) = (parent, self.sibling(node));
        let mut shrunk = self.extents[side as usize];
        loop {
            todo.push((saved, side));
            while let Some((saved, to)) = todo.pop() {
                if saved - area <= best.gain {
                    continue;
                }
                // A new parent of both; what lies above the place grows to its size, too.
                let gain = saved - self.area_with(to, extent);
                if gain > best.gain {
                    best = Move { node, to, gain };
                }
                let [left, right] = self.links[to as usize].children;
                let inside = gain + self.area(to);
                if left != 0 && inside - area > best.gain {
                    todo.extend([(inside, left), (inside, right)]);
                }
            }
            if pivot == 0 {
                break;
            }
            if pivot != parent {
                shrunk.grow::<Portable>(&self.extents[side as usize]);
                saved += self.area(pivot) - shrunk.half_area();
            }
            side = self.sibling(pivot);
            pivot = self.links[pivot as usize].parent;
        }
        best
    }

    /// Whether a node lies in a subtree: earlier moves of the round may have put it there.
    fn is_below(&self, mut node: u32, root: u32) -> bool {
        while node != 0 && node != root {
            node = self.links[node as usize].parent;
        }
        node == root
    }

    /// The nodes whose links a move changes, or relies on.
    fn nodes_of(&self, step: &Move) -> [u32; 6] {
        let parent = self.links[step.node as usize].parent;
        let grandparent = self.links[parent as usize].parent;
        [step.node, self.sibling(step.node), parent, grandparent, step.to, self.links[step.to as usize].parent]
    }

    /// Takes a subtree out; its parent becomes that of it and of its new sibling.
    fn apply(&mut self, step: &Move) -> Result<()> {
        let (node, to) = (step.node, step.to);
        let (parent, sibling) = (self.links[node as usize].parent, self.sibling(node));
        let (grandparent, above) = (self.links[parent as usize].parent, self.links[to as usize].parent);
        [parent, sibling, grandparent, to, above].into_iter().try_for_each(|node| self.remember(node))?;
        self.replace_child(grandparent, parent, sibling);
        self.replace_child(above, to, parent);
        self.links[parent as usize].children = [to, node];
        self.links[to as usize].parent = parent;
        self.extents[parent as usize] = self.union_of_children(parent);
        self.refit(grandparent)?;
        self.refit(above)
    }

    fn union_of_children(&self, node: u32) -> Extent {
        let [left, right] = self.links[node as usize].children;
        let mut both = self.extents[left as usize];
        both.grow::<Portable>(&self.extents[right as usize]);
        both
    }

    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        for child in &mut self.links[parent as usize].children {
            if *child == old {
                *child = new;
            }
        }
        self.links[new as usize].parent = parent;
    }

    /// Boxes from a node up, as far as they change.
    fn refit(&mut self, mut node: u32) -> Result<()> {
        loop {
            let (both, old) = (self.union_of_children(node), self.extents[node as usize]);
            let is_same = (both.min, both.negated_max) == (old.min, old.negated_max);
            if is_same {
                return Ok(());
            }
            self.remember(node)?;
            self.extents[node as usize] = both;
            if node == 0 {
                return Ok(());
            }
            node = self.links[node as usize].parent;
        }
    }

    fn depth(&self, parallel: bool) -> u32 {
        if !parallel {
            return self.depth_below(0);
        }
        let (mut level, mut depth) = (vec![0u32], 0);
        while depth < SHARED_BELOW {
            let children = level.iter().flat_map(|&node| self.links[node as usize].children);
            let next: Vec<u32> = children.filter(|&child| child != 0).collect();
            if next.is_empty() {
                return depth;
            }
            (level, depth) = (next, depth + 1);
        }
        depth + level.par_iter().map(|&node| self.depth_below(node)).max().unwrap_or(0)
    }

    /// Of a subtree.
    fn depth_below(&self, root: u32) -> u32 {
        let (mut deepest, mut todo) = (0, vec![(root, 0)]);
        while let Some((node, depth)) = todo.pop() {
            deepest = deepest.max(depth);
            let [left, right] = self.links[node as usize].children;
            if left != 0 {
                todo.extend([(left, depth + 1), (right, depth + 1)]);
            }
        }
        deepest
    }

    /// As the other stages want it; the leaves keep their ranges.
    fn in_preorder(&self, old: &[BinaryNode]) -> Result<Vec<BinaryNode>> {
        let mut nodes: Vec<BinaryNode> = Vec::new();
        reserve(&mut nodes, old.len(), "nodes")?;
        // A node, and the place of the parent whose right child it is.
        let mut todo: Vec<(u32, Option<usize>)> = vec![(0, None)];
        while let Some((node, parent)) = todo.pop() {
            let place = nodes.len();
            if let Some(parent) = parent {
                nodes[parent] = BinaryNode::interior(nodes[parent].0, place as u32);
            }
            let [left, right] = self.links[node as usize].children;
            if left == 0 {
                nodes.push(old[node as usize]);
            } else {
                nodes.push(BinaryNode::interior(self.extents[node as usize], 0));
                todo.extend([(right, Some(place)), (left, None)]);
            }
        }
        Ok(nodes)
    }
}
