//! A kd-tree taken apart: its nodes with their boxes, and how many rays of any set visit each.

use rdh::kd::{Costs, KdTree, Shown};
use rdh::{Aabb, Axis};

use super::bound::Segment;

/// The nodes of a kd-tree, each before its children; the left child follows its parent.
#[derive(Debug)]
pub struct Skeleton {
    nodes: Vec<Bone>,
}

/// A node.
#[derive(Debug, Clone, Copy)]
pub struct Bone {
    /// Its cell.
    pub cell: Aabb,
    /// Edges from the root.
    pub depth: usize,
    /// Its triangles, if it is a leaf.
    pub triangles: usize,
    /// Its split, and which node its right child is; nothing for a leaf.
    pub split: Option<(Axis, f32, usize)>,
}

impl Skeleton {
    /// Takes a tree apart.
    pub fn of(tree: &KdTree) -> Self {
        let mut nodes: Vec<Bone> = Vec::new();
        // The ancestors of the node that comes next, by depth.
        let mut path: Vec<usize> = Vec::new();
        tree.walk(&mut |cell, depth, node| {
            let here = nodes.len();
            path.truncate(depth);
            let parent = path.last().map(|&parent| (parent, &mut nodes[parent]));
            if let Some((index, Bone { split: Some((_, _, right)), .. })) = parent
                && index + 1 != here
            {
                *right = here;
            }
            path.push(here);
            nodes.push(match node {
                Shown::Interior { axis, plane } => {
                    Bone { cell: *cell, depth, triangles: 0, split: Some((axis, plane, 0)) }
                }
                Shown::Leaf { triangles } => Bone { cell: *cell, depth, triangles: triangles.len(), split: None },
            });
        });
        Self { nodes }
    }

    /// The nodes.
    pub fn nodes(&self) -> &[Bone] {
        &self.nodes
    }

    /// How many of the rays visit each node.
    pub fn visits(&self, rays: &[Segment]) -> Vec<f64> {
        let mut visits = vec![0.0; self.nodes.len()];
        let Some(root) = self.nodes.first() else { return visits };
        let (min, max) = (root.cell.min.map(f64::from), root.cell.max.map(f64::from));
        let enter = |ray: &Segment| (0..3).try_fold(*ray, |ray, axis| ray.clip(axis, min[axis], max[axis]));
        self.follow(0, &rays.iter().filter_map(enter).collect::<Vec<_>>(), &mut visits);
        visits
    }

    fn follow(&self, node: usize, rays: &[Segment], visits: &mut [f64]) {
        visits[node] = rays.len() as f64;
        let Some((axis, plane, right)) = self.nodes[node].split else { return };
        if rays.is_empty() {
            return;
        }
        let (a, plane) = (axis.index(), f64::from(plane));
        let left_of = rays.iter().filter_map(|ray| ray.clip(a, f64::NEG_INFINITY, plane));
        self.follow(node + 1, &left_of.collect::<Vec<_>>(), visits);
        let right_of = rays.iter().filter_map(|ray| ray.clip(a, plane, f64::INFINITY));
        self.follow(right, &right_of.collect::<Vec<_>>(), visits);
    }

    /// The area of each node's cell: what visits are proportional to under uniform lines that nothing stops.
    pub fn areas(&self) -> Vec<f64> {
        let area = |bone: &Bone| {
            let [x, y, z] = bone.cell.extent().map(f64::from);
            x * y + y * z + z * x
        };
        self.nodes.iter().map(area).collect()
    }

    /// What a ray that meets the tree pays, if nodes are visited in these proportions.
    pub fn cost(&self, visits: &[f64], costs: &Costs) -> f64 {
        let price = |bone: &Bone| match bone.split {
            Some(_) => f64::from(costs.traverse),
            None => f64::from(costs.leaf(bone.triangles)),
        };
        let total: f64 = self.nodes.iter().zip(visits).map(|(bone, v)| v * price(bone)).sum();
        visits.first().filter(|&&root| root > 0.0).map_or(0.0, |root| total / root)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::tally;
    use crate::study::lines::uniform_lines;
    use rdh::{BuildOptions, Mesh, Query, RaySample, Spec, Training};

    #[test]
    fn counted_visits_are_those_of_the_traversal() {
        let at = |i: u32, k: u32| {
            let (i, k) = (i as f32, k as f32);
            [i * 37.0 % 101.0 + 3.0 * k, i * 59.0 % 103.0 + k * k, i * 17.0 % 71.0 + 2.0 * k]
        };
        let positions = (0..500).flat_map(|i| [at(i, 0), at(i, 1), at(i + 1, 2)]).collect();
        let mesh = Mesh::new(positions, (0..500).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
        let accel = rdh::build(&mesh, &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        let batch = uniform_lines(&mesh.bounds(), 2000, 3);
        let sample = |ray| RaySample::new(ray, accel.closest(&ray), Query::Closest, batch.class);
        let rays = Training::from_samples(batch.rays.iter().copied().map(sample).collect());
        let skeleton = Skeleton::of(accel.kd_tree().unwrap());
        assert_eq!(skeleton.nodes().len(), accel.stats().nodes);
        let counted: f64 = skeleton.visits(&Segment::all(&rays)).iter().sum();
        let walked = tally(&accel, &batch).counts.steps() as f64;
        // Rays count as a little wider when they are cast.
        assert!((counted - walked).abs() < 2e-3 * walked, "{counted} {walked}");
    }
}
