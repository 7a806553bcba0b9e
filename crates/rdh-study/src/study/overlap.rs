//! How much of the space that new rays cross did a profile know?

use rdh::Aabb;

use super::bound::Segment;

/// Cells of the grid along each axis.
const CELLS: usize = 16;

/// The part of two sets' visits to the cells of a grid over the scene that they have in common: the sum of the lesser of
/// both shares, 1 for equal sets and 0 for sets that never meet. Needs no tree, and few rays.
pub fn overlap(bounds: &Aabb, one: &[Segment], other: &[Segment]) -> f64 {
    let [one, other] = [one, other].map(|rays| shares(bounds, rays));
    one.iter().zip(&other).map(|(a, b)| a.min(*b)).sum()
}

/// Each cell's share of all visits.
fn shares(bounds: &Aabb, rays: &[Segment]) -> Vec<f64> {
    let mut visits = vec![0.0; CELLS.pow(3)];
    for ray in rays {
        visit(bounds, *ray, 0, 0, &mut visits);
    }
    let all: f64 = visits.iter().sum();
    if all > 0.0 {
        visits.iter_mut().for_each(|v| *v /= all);
    }
    visits
}

/// Slab by slab, then column by column, then cell by cell.
fn visit(bounds: &Aabb, ray: Segment, axis: usize, index: usize, visits: &mut [f64]) {
    if axis == 3 {
        visits[index] += 1.0;
        return;
    }
    let (low, extent) = (f64::from(bounds.min[axis]), f64::from(bounds.extent()[axis]));
    let plane = |i: usize| low + extent * i as f64 / CELLS as f64;
    for i in 0..CELLS {
        if let Some(part) = ray.clip(axis, plane(i), plane(i + 1)) {
            visit(bounds, part, axis + 1, index * CELLS + i, visits);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::Ray;

    #[test]
    fn equal_sets_overlap_wholly_and_strangers_not_at_all() {
        let bounds = Aabb { min: [0.0; 3], max: [1.0; 3] };
        let along = |y: f32| Segment::new(&Ray::new([-1.0, y, 0.51], [1.0, 0.0, 0.0]), f32::INFINITY);
        let (low, high) = (along(0.1), along(0.9));
        assert!((overlap(&bounds, &[low], &[low]) - 1.0).abs() < 1e-9);
        assert_eq!(overlap(&bounds, &[low], &[high]), 0.0);
        assert!((overlap(&bounds, &[low, high], &[high]) - 0.5).abs() < 1e-9);
        assert_eq!(overlap(&bounds, &[], &[high]), 0.0);
    }
}
