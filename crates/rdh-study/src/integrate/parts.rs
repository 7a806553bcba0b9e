//! The connected parts of a mesh.

use rdh::Mesh;

/// For each triangle, the number of the connected part it is in; parts are numbered by their first triangle.
///
/// Triangles are connected if they share a vertex *position*: files often store a vertex once per triangle. O(n log n).
pub(crate) fn connected_parts(mesh: &Mesh) -> Vec<u32> {
    let mut sets = Sets::new(mesh.positions().len());
    join_equal_positions(mesh, &mut sets);
    for &[a, b, c] in mesh.triangles() {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut number_of_root = vec![u32::MAX; mesh.positions().len()];
    let mut parts = 0;
    let number = |&[a, _, _]: &[u32; 3]| {
        let slot = &mut number_of_root[sets.root(a) as usize];
        if *slot == u32::MAX {
            *slot = parts;
            parts += 1;
        }
        *slot
    };
    mesh.triangles().iter().map(number).collect()
}

fn join_equal_positions(mesh: &Mesh, sets: &mut Sets) {
    // Adding 0 makes -0 and 0 the same position.
    let bits = |i: u32| mesh.positions()[i as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    order.sort_unstable_by_key(|&i| bits(i));
    for pair in order.windows(2) {
        if bits(pair[0]) == bits(pair[1]) {
            sets.join(pair[0], pair[1]);
        }
    }
}

/// Disjoint sets with path halving; the smaller index becomes the root.
struct Sets(Vec<u32>);

impl Sets {
    fn new(len: usize) -> Self {
        Self((0..len as u32).collect())
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let grandparent = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_join_over_shared_indices_and_equal_positions() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [5.0, 0.0, 0.0],
            [6.0, 0.0, 0.0],
            [5.0, 1.0, 0.0],
            // The first corner once more, as -0.
            [-0.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
        ];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [5, 4, 3]]).unwrap();
        assert_eq!(connected_parts(&mesh), [0, 1, 0, 1]);
    }

    #[test]
    fn an_empty_mesh_has_no_parts() {
        assert!(connected_parts(&Mesh::default()).is_empty());
    }
}
