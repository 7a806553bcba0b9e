//! The surface area heuristic: uniform lines that nothing stops (Goldsmith and Salmon 1987; MacDonald and Booth 1990).

use super::{Heuristic, NodeRays};
use crate::geom::{Aabb, Axis};

/// p = area of the child / area of the node: for uniform lines, the chance that one which meets the node meets the child.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sah;

impl Heuristic for Sah {
    fn root(&self, _bounds: &Aabb) -> NodeRays {
        NodeRays::default()
    }

    fn descend(&self, _rays: &NodeRays, _child: &Aabb) -> NodeRays {
        NodeRays::default()
    }

    fn sweep(&self, _rays: &NodeRays, node: &Aabb, axis: Axis, planes: &[f32], left: &mut [f32], right: &mut [f32]) {
        let a = axis.index();
        let extent = node.extent();
        let (across, along) = (extent[(a + 1) % 3], extent[(a + 2) % 3]);
        let area = extent[a] * (across + along) + across * along;
        // Both children have the two end faces; the four sides are shared in proportion to length. A node without any
        // area (a line or a point) is treated as met by every ray on both sides.
        let (ends, per_length) = if area > 0.0 { (across * along / area, (across + along) / area) } else { (1.0, 0.0) };
        let (min, max) = (node.min[a], node.max[a]);
        for ((&plane, left), right) in planes.iter().zip(left).zip(right) {
            *left = ends + (plane - min) * per_length;
            *right = ends + (max - plane) * per_length;
        }
    }
}
