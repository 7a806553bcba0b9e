//! Well-formedness of what has grown, and of what waits.

use super::Lazy;
use super::growth::Place;
use super::part::DEEPEST;
use super::runs;
use super::subtree::Grown;
use crate::bvh::Extent;
use crate::fault::{Fault, Faults};
use crate::geom::{Aabb, TriId};
use crate::mesh::Mesh;
use crate::parts;
use crate::simd::LANES;

impl Lazy {
    /// All faults of the structure over its mesh, at most 100: depth, boxes that do not hold what is below them, faults of whole trees,
    /// and triangles that are missing or there twice. O(n).
    pub fn check(&self, mesh: &Mesh) -> Vec<Fault> {
        let mut check = Check { mesh, faults: Faults::default(), held: vec![Held::NOTHING; mesh.len()] };
        self.tree.each(&mut |place| check.visit(place, self.tree.ground.space.scale.factor()));
        check.completeness(self.tree.ground.space.scale.factor());
        check.faults.all()
    }
}

struct Check<'a> {
    mesh: &'a Mesh,
    faults: Faults,
    held: Vec<Held>,
}

/// What is found of a triangle.
#[derive(Clone, Copy)]
struct Held {
    times: u32,
    /// The box of the leaf, or the subtree, that has it.
    by: Aabb,
}

impl Held {
    const NOTHING: Self = Self { times: 0, by: Aabb::EMPTY };
}

const ROOT: parts::Place = parts::Place { part: parts::Part::Root, byte: 0 };

impl Check<'_> {
    fn visit(&mut self, place: &Place<'_>, factor: f32) {
        let depth = place.subtree.depth();
        if depth > DEEPEST {
            self.faults.add(ROOT, format!("a subtree lies at depth {depth}; {DEEPEST} is too deep"));
        }
        if !place.outer.holds(&place.bounds) && !place.bounds.is_empty() {
            self.faults.add(ROOT, format!("a subtree at depth {depth} reaches out of its parent's box"));
        }
        match place.subtree.grown() {
            Some(Grown::Node(node)) => {
                let present = (0..LANES).filter(|&lane| node.boxes.is_present(lane)).count();
                if present != node.children.len() {
                    let what =
                        format!("a node at depth {depth} has {present} boxes and {} subtrees", node.children.len());
                    self.faults.add(ROOT, what);
                }
            }
            Some(Grown::Tree(tree)) => {
                if let Err((at, Fault(what))) = tree.tally_checked(self.mesh) {
                    return self.faults.add(at, format!("in a tree at depth {depth}: {what}"));
                }
                tree.cells(&mut |cell, _, ids| {
                    let cell = Aabb { min: cell.min.map(|x| x * factor), max: cell.max.map(|x| x * factor) };
                    if !place.bounds.holds(&cell) {
                        self.faults
                            .add(ROOT, format!("a leaf in a tree at depth {depth} reaches out of its parent's box"));
                    }
                    ids.iter().for_each(|&id| self.hold(id, &cell));
                });
            }
            Some(Grown::Bare(runs)) => self.hold_all(runs, &place.bounds),
            None => place.subtree.with_waiting(|runs| self.hold_all(runs, &place.bounds)),
        }
    }

    fn hold_all(&mut self, runs: &[Extent], bounds: &Aabb) {
        for run in runs {
            let mesh = self.mesh;
            if run.link as usize + run.count as usize > mesh.len() {
                self.faults.add(ROOT, format!("a run from triangle {} on is too long", run.link));
                continue;
            }
            runs::triangles(mesh, *run).for_each(|TriId(id)| self.hold(id, bounds));
        }
    }

    fn hold(&mut self, id: u32, by: &Aabb) {
        if let Some(held) = self.held.get_mut(id as usize) {
            *held = Held { times: held.times + 1, by: *by };
        }
    }

    fn completeness(&mut self, factor: f32) {
        for tri in self.mesh.solid() {
            let Held { times, by } = self.held[tri.index()];
            let bounds = Aabb::around(&self.mesh.corners(tri).map(|c| c.map(|x| x * factor)));
            if times != 1 {
                self.faults.add(ROOT, format!("triangle {} is there {times} times", tri.0));
            } else if !by.holds(&bounds) {
                self.faults.add(ROOT, format!("triangle {} is not held by the box that has it", tri.0));
            }
        }
    }
}
