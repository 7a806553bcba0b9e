//! What a plane cuts: cells and triangles.

use rdh::{Accel, Mesh, TriId};

use super::Plane;

/// A leaf cell that the plane cuts, in the plane's two axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CutCell {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    pub(super) triangles: usize,
}

/// The leaf cells that a plane cuts. One that only touches it counts on its lower side only, so that none lies on another.
pub(super) fn cut_cells(accel: &Accel, plane: &Plane) -> Vec<CutCell> {
    let (bounds, axes) = (accel.bounds(), Plane::axes(plane.axis));
    let last = f64::from(bounds.max[plane.axis]);
    let mut cut = Vec::new();
    accel.cells(&mut |cell, _depth, triangles| {
        let (low, high) = (f64::from(cell.min[plane.axis]), f64::from(cell.max[plane.axis]));
        if low <= plane.position && (plane.position < high || plane.position >= last && high >= last) {
            let (low, high) = (axes.map(|a| f64::from(cell.min[a])), axes.map(|a| f64::from(cell.max[a])));
            cut.push(CutCell { low, high, triangles });
        }
    });
    cut
}

/// Where triangles meet the plane: line segments in its two axes.
pub(super) fn cut_triangles<'a>(mesh: &'a Mesh, plane: &'a Plane) -> impl Iterator<Item = [[f64; 2]; 2]> + 'a {
    (0..mesh.len() as u32).filter_map(|i| cut_triangle(&mesh.corners(TriId(i)).map(|c| c.map(f64::from)), plane))
}

/// The first two points at which edges cross the plane. An edge belongs to the side of its corners: `>=` is above.
fn cut_triangle(corners: &[[f64; 3]; 3], plane: &Plane) -> Option<[[f64; 2]; 2]> {
    let axes = Plane::axes(plane.axis);
    let crossing = |(i, j): (usize, usize)| {
        let (a, b) = (corners[i], corners[j]);
        let (da, db) = (a[plane.axis] - plane.position, b[plane.axis] - plane.position);
        ((da < 0.0) != (db < 0.0)).then(|| axes.map(|x| a[x] + (b[x] - a[x]) * (da / (da - db))))
    };
    let mut points = [(0, 1), (1, 2), (2, 0)].into_iter().filter_map(crossing);
    Some([points.next()?, points.next()?])
}

#[cfg(test)]
mod tests {
    use rdh::{BuildOptions, Spec, Training, build};

    use super::*;

    #[test]
    fn a_triangle_is_cut_across() {
        let plane = Plane { axis: 2, position: 1.0, near: 0.0 };
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 2.0], [0.0, 4.0, 2.0]];
        assert_eq!(cut_triangle(&corners, &plane), Some([[2.0, 0.0], [0.0, 2.0]]));
        assert_eq!(cut_triangle(&corners.map(|c| [c[0], c[1], 5.0]), &plane), None);
    }

    #[test]
    fn the_cut_cells_tile_the_scene() {
        let positions: Vec<_> = (0..600).map(|i| [i % 7, i * 13 % 11, i * 29 % 23].map(|x| x as f32)).collect();
        let triangles = (0..200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = Mesh::new(positions, triangles).unwrap();
        let accel = build(&mesh, &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        for position in [0.0, 2.0, 3.5, 6.0] {
            let cells = cut_cells(&accel, &Plane { axis: 0, position, near: 0.0 });
            let area: f64 = cells.iter().map(|c| (c.high[0] - c.low[0]) * (c.high[1] - c.low[1])).sum();
            assert!((area - 10.0 * 22.0).abs() < 1e-3, "{position}: {area}");
        }
    }
}
