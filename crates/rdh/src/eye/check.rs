//! Proving trees well-formed: from the other end, by sending each triangle to all cells that it reaches.

use super::EyeTree;
use super::cell::Cell;
use super::face::{Face, Kind, Node};
use super::grow::DEEPEST;
use super::viewer::Viewer;
use crate::fault::{Fault, Faults};
use crate::geom::TriId;
use crate::mesh::Mesh;
use crate::parts::{Part, Place};
use crate::simd::{Entry, Sight, step_of};

impl EyeTree {
    /// All faults of the trees over their mesh; none if they are well-formed. O(N log N) for each side, and what the other
    /// structure's check takes.
    pub fn check(&self) -> Vec<Fault> {
        self.check_over(self.world.mesh())
    }

    pub(super) fn check_over(&self, mesh: &Mesh) -> Vec<Fault> {
        let mut faults = Faults::default();
        for face in self.faces.iter().flatten() {
            Check { tree: self, face, mesh, faults: &mut faults, pairs: 0 }.run();
        }
        let mut all = faults.all();
        all.extend(self.world.check(mesh));
        all
    }
}

struct Check<'a> {
    tree: &'a EyeTree,
    face: &'a Face,
    mesh: &'a Mesh,
    faults: &'a mut Faults,
    /// How many pairs were met.
    pairs: usize,
}

impl Check<'_> {
    fn run(&mut self) {
        self.corners();
        let seen = self.seen();
        self.node(self.face.root, self.face.window, &seen, 0);
        if self.pairs != self.face.pairs.len() {
            self.add(format!("{} pairs of nodes, of which {} are met", self.face.pairs.len(), self.pairs));
        }
    }

    fn add(&mut self, what: String) {
        let side = self.face.side.index();
        self.faults.add(Place { part: Part::Nodes, byte: 0 }, format!("side {side}: {what}"));
    }

    /// Copies of corners are the mesh's, bit for bit.
    fn corners(&mut self) {
        if self.face.corners.len() != self.face.sights.len() {
            self.add("not as many corners as sights".to_owned());
        }
        for (i, (sight, corners)) in self.face.sights.iter().zip(&self.face.corners).enumerate() {
            let bits = |c: [f32; 3]| c.map(f32::to_bits);
            let faithful = (sight.id as usize) < self.mesh.len()
                && corners[0][3].to_bits() == sight.id
                && self
                    .mesh
                    .corners(TriId(sight.id))
                    .iter()
                    .zip(corners)
                    .all(|(c, [x, y, z, _])| bits(self.face.side.along(c)) == bits([*x, *y, *z]));
            if !faithful {
                self.add(format!("sight {i}: differs from the mesh"));
            }
        }
    }

    /// The triangles that the side sees in its window, and their boxes.
    fn seen(&self) -> Vec<(Sight, Cell)> {
        let EyeTree { form, passing, .. } = self.tree;
        let viewer = Viewer { mesh: self.mesh, form: *form, passing };
        let ids = 0..self.mesh.len() as u32;
        ids.filter_map(|id| viewer.look_at(self.face.side, id, &self.face.window)).collect()
    }

    fn node(&mut self, node: Node, cell: Cell, seen: &[(Sight, Cell)], depth: u32) {
        if depth > DEEPEST {
            return self.add("too deep".to_owned());
        }
        match node.kind() {
            Kind::Split { axis, at, pair } => {
                self.pairs += 1;
                let inside = axis < 2 && at >= cell.low[axis] && at <= cell.high[axis];
                if !inside || pair >= self.face.pairs.len() || self.pairs > self.face.pairs.len() {
                    return self.add(format!("a line at {at} across {axis}, or its pair {pair}, is none"));
                }
                for (child, cell) in self.face.pairs[pair].into_iter().zip(cell.split(axis, at)) {
                    let seen: Vec<_> = seen.iter().filter(|(_, place)| place.meets(&cell)).copied().collect();
                    self.node(child, cell, &seen, depth + 1);
                }
            }
            Kind::Leaf { first, count } => match self.face.entries.get(first..first + count) {
                Some(entries) => self.leaf(entries, &cell, seen),
                None => self.add(format!("a leaf's entries {first} to {} are none", first + count)),
            },
        }
    }

    /// Triangles come nearest first, their boxes in the cell; and each that the side sees in the cell is there, or behind one that covers
    /// the cell.
    fn leaf(&mut self, entries: &[Entry], cell: &Cell, seen: &[(Sight, Cell)]) {
        if !entries.iter().all(|e| (e.sight as usize) < self.face.sights.len()) {
            return self.add("an entry's sight is none".to_owned());
        }
        if !entries.is_sorted_by(|a, b| a.near >= b.near) {
            self.add("a leaf's triangles are out of order".to_owned());
        }
        let steps = |x: [f32; 2]| x.map(|x| f32::from(step_of(x)));
        let cell_steps = Cell { low: steps(cell.low), high: steps(cell.high) };
        if entries.iter().any(|e| !cell_steps.meets(&Cell { low: e.low.map(f32::from), high: e.high.map(f32::from) })) {
            self.add("a leaf's triangle lies beside its cell".to_owned());
        }
        let sight = |e: &Entry| &self.face.sights[e.sight as usize];
        let hidden = entries.iter().filter_map(|e| cell.covered_by(sight(e))).fold(f64::NEG_INFINITY, f64::max);
        let hidden = if self.tree.drops_hidden() { hidden } else { f64::NEG_INFINITY };
        let mut listed: Vec<u32> = entries.iter().map(|e| sight(e).id).collect();
        listed.sort_unstable();
        let missing = |sight: &Sight| {
            let near = cell.nearness(sight).1;
            // But for the last bit.
            cell.may_see(sight) && near - near.abs() * 1e-9 >= hidden && listed.binary_search(&sight.id).is_err()
        };
        let missing: Vec<u32> = seen.iter().filter(|(s, _)| missing(s)).map(|(s, _)| s.id).collect();
        for id in missing {
            self.add(format!("triangle {id} is missing in the cell {cell:?}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::EyeOptions;
    use crate::geom::Ray;
    use crate::options::BuildOptions;
    use crate::rays::Training;

    /// A curved sheet before the eye, and another behind it.
    fn sheets() -> Mesh {
        const N: u32 = 24;
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for z in [2.0, 3.0] {
            let first = positions.len() as u32;
            for i in 0..=N * N + 2 * N {
                let (x, y) = ((i % (N + 1)) as f32 / 10.0 - 1.2, (i / (N + 1)) as f32 / 10.0 - 1.2);
                positions.push([x, y, z + 0.1 * x * y]);
            }
            for i in (0..N * (N + 1)).filter(|i| i % (N + 1) != N) {
                let i = first + i;
                triangles.extend([[i, i + 1, i + N + 1], [i + 1, i + N + 2, i + N + 1]]);
            }
        }
        Mesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn a_broken_tree_is_noticed() {
        let world =
            crate::build(&sheets(), &"bvh8".parse().unwrap(), &Training::none(), &BuildOptions::default()).unwrap();
        let options = (EyeOptions::default(), BuildOptions::default());
        let whole = EyeTree::build(world, [0.0; 3], &Training::none(), &options.0, &options.1).unwrap();
        assert!(whole.closest(&Ray::new([0.0; 3], [0.1, 0.2, 1.0])).is_some());
        let broken = |break_it: fn(&mut Face)| {
            let mut tree = whole.clone();
            break_it(tree.faces[4].as_mut().unwrap());
            !tree.check().is_empty()
        };
        assert!(!broken(|_| {}));
        assert!(broken(|f| f.corners[3][1][0] += 1.0));
        assert!(broken(|f| f.entries.truncate(f.entries.len() / 2)));
        assert!(broken(|f| f.entries.iter_mut().for_each(|e| e.sight = 0)));
        assert!(broken(|f| f.pairs[0] = [f.root; 2]));
        assert!(broken(|f| f.entries.reverse()));
    }
}
