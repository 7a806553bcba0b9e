//! How many triangles and rays there are in every box of a lattice.

use super::lattice::{Cell, Lattice};
use super::shape::{Part, Segment};

/// Triangles in every box. One that lies flat in a plane is in the box above it; in the lattice's last plane, below.
#[derive(Debug)]
pub struct TriangleCounts(Vec<u32>);

/// Rays in every box.
#[derive(Debug)]
pub struct RayCounts(Vec<u32>);

impl TriangleCounts {
    /// Counts all boxes' triangles.
    pub fn new(lattice: &Lattice, parts: Vec<Part>) -> Self {
        let within = |part: &Part, axis: usize, cell: &Cell| -> Option<Part> {
            let planes = lattice.planes(axis);
            let [_, above] = part.split(axis, planes[cell.low[axis]], false);
            let last = cell.high[axis] + 1 == planes.len();
            let [below, _] = above?.split(axis, planes[cell.high[axis]], last);
            below
        };
        Self(count(lattice, parts, &within))
    }

    /// How many are in a box.
    pub fn of(&self, lattice: &Lattice, cell: &Cell) -> usize {
        self.0[lattice.number(cell)] as usize
    }
}

impl RayCounts {
    /// Counts all boxes' rays.
    pub fn new(lattice: &Lattice, rays: Vec<Segment>) -> Self {
        let within = |ray: &Segment, axis: usize, cell: &Cell| {
            let planes = lattice.planes(axis);
            ray.clip(axis, planes[cell.low[axis]], planes[cell.high[axis]])
        };
        Self(count(lattice, rays, &within))
    }

    /// How many are in a box.
    pub fn of(&self, lattice: &Lattice, cell: &Cell) -> usize {
        self.0[lattice.number(cell)] as usize
    }
}

/// What is left of a thing between a box's two planes across an axis.
type Within<'a, T> = dyn Fn(&T, usize, &Cell) -> Option<T> + 'a;

/// Slab by slab, column by column, box by box: each from what was left in the one around it.
fn count<T>(lattice: &Lattice, all: Vec<T>, within: &Within<'_, T>) -> Vec<u32> {
    let mut counts = vec![0; lattice.numbers()];
    descend(lattice, &all, 0, lattice.whole(), within, &mut counts);
    counts
}

fn descend<T>(lattice: &Lattice, left: &[T], axis: usize, around: Cell, within: &Within<'_, T>, counts: &mut [u32]) {
    if axis == 3 {
        counts[lattice.number(&around)] = left.len() as u32;
        return;
    }
    for low in 0..lattice.planes(axis).len() - 1 {
        for high in low + 1..lattice.planes(axis).len() {
            let mut cell = around;
            (cell.low[axis], cell.high[axis]) = (low, high);
            let inside: Vec<T> = left.iter().filter_map(|thing| within(thing, axis, &cell)).collect();
            // Nothing in it: the boxes within keep their zeros.
            if !inside.is_empty() {
                descend(lattice, &inside, axis + 1, cell, within, counts);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::{Mesh, Ray};

    #[test]
    fn boxes_count_what_lies_in_them() {
        let positions = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [2.0, 2.0, 2.0]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 3, 4]]).unwrap();
        let lattice = Lattice::even([2, 2, 2]);
        let triangles = TriangleCounts::new(&lattice, Part::all(&mesh));
        assert_eq!(triangles.of(&lattice, &lattice.whole()), 2);
        let corner = |low: [usize; 3]| Cell { low, high: low.map(|i| i + 1) };
        // The first lies in the floor's lower corner, and cuts the three boxes of the floor but the far one.
        let floor: Vec<_> =
            [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]].map(|c| triangles.of(&lattice, &corner(c))).into();
        assert_eq!(floor, [2, 1, 1, 0]);
        let ray = Ray::new([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
        let rays = RayCounts::new(&lattice, vec![Segment::new(&ray, f32::INFINITY), Segment::new(&ray, 1.5)]);
        let [near, far] = [[0, 0, 0], [1, 0, 0]].map(|c| rays.of(&lattice, &corner(c)));
        assert_eq!((near, far, rays.of(&lattice, &corner([0, 1, 0]))), (2, 1, 0));
    }
}
