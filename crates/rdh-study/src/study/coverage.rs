//! How much of the space that new rays cross did a profile know?

use rdh::Aabb;

use super::bound::Segment;

/// Cells of the grid along each axis.
const CELLS: usize = 16;

/// The part of the new rays' way, in visits to the cells of a grid over the scene, that goes through cells which a
/// profile's rays visit too: 1 if it knew all of it, 0 if none. Needs no tree, and few rays of either.
pub fn coverage(bounds: &Aabb, profile: &[Segment], new: &[Segment]) -> f64 {
    let [known, new] = [profile, new].map(|rays| visits(bounds, rays));
    let all: u64 = new.iter().sum();
    let covered: u64 = new.iter().zip(&known).filter(|(_, known)| **known > 0).map(|(n, _)| n).sum();
    covered as f64 / all.max(1) as f64
}

fn visits(bounds: &Aabb, rays: &[Segment]) -> Vec<u64> {
    let mut visits = vec![0; CELLS.pow(3)];
    for ray in rays {
        visit(bounds, *ray, 0, 0, &mut visits);
    }
    visits
}

/// Slab by slab, then column by column, then cell by cell.
fn visit(bounds: &Aabb, ray: Segment, axis: usize, index: usize, visits: &mut [u64]) {
    if axis == 3 {
        visits[index] += 1;
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
    fn what_is_known_is_covered_and_what_is_not_is_not() {
        let bounds = Aabb { min: [0.0; 3], max: [1.0; 3] };
        let along = |y: f32| Segment::new(&Ray::new([-1.0, y, 0.51], [1.0, 0.0, 0.0]), f32::INFINITY);
        let (low, high) = (along(0.1), along(0.9));
        assert_eq!(coverage(&bounds, &[low], &[low]), 1.0);
        assert_eq!(coverage(&bounds, &[low], &[high]), 0.0);
        assert_eq!(coverage(&bounds, &[low], &[low, high]), 0.5);
        assert_eq!(coverage(&bounds, &[low, high], &[high]), 1.0);
        assert_eq!(coverage(&bounds, &[low], &[]), 0.0);
    }
}
