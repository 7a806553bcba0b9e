//! Small scenes: the best tree there is over a lattice, against the greedy one.

use rdh::Training;
use rdh::kd::Costs;

use super::contents::{RayCounts, TriangleCounts};
use super::lattice::{Cell, Lattice};
use super::optimal::{Prices, Tree, greedy, optimal};
use super::shape::{Part, Segment};

/// A lattice over a scene, with all its boxes' triangles.
#[derive(Debug)]
pub struct SmallScene {
    lattice: Lattice,
    triangles: TriangleCounts,
}

/// What the trees over a lattice cost the test rays: c_t steps + c_i tests a ray, and steps and tests themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paid {
    /// In units of a step.
    pub cost: f64,
    /// Interior nodes and leaves visited.
    pub steps: f64,
    /// Triangles in the leaves visited.
    pub tests: f64,
}

/// The trees that are compared. "By rays" trusts the training rays; "oracle" knows the test rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallBound {
    /// SAH as it is.
    pub greedy_by_areas: Paid,
    /// The best that areas can lead to.
    pub optimal_by_areas: Paid,
    /// The builder's rule with the rays' counts.
    pub greedy_by_rays: Paid,
    /// The best for the training rays.
    pub optimal_by_rays: Paid,
    /// The builder's rule, knowing the test rays.
    pub greedy_by_oracle: Paid,
    /// The best for the test rays: no tree over the lattice can be cheaper.
    pub optimal_by_oracle: Paid,
}

impl SmallScene {
    /// At most `most` intervals an axis, between the `preferred` planes first. Nothing for scenes that are flat along an axis.
    pub fn new(parts: Vec<Part>, preferred: &[(usize, f64)], most: usize) -> Option<Self> {
        let lattice = Lattice::over(&parts, preferred, most)?;
        let triangles = TriangleCounts::new(&lattice, parts);
        Some(Self { lattice, triangles })
    }

    /// The rays in every box.
    pub fn rays(&self, rays: &Training) -> RayCounts {
        RayCounts::new(&self.lattice, Segment::all(rays))
    }

    /// Builds all trees and lets the test rays pay.
    pub fn bound(&self, costs: &Costs, training: &RayCounts, test: &RayCounts) -> SmallBound {
        let [areas, rays, oracle] =
            [None, Some(training), Some(test)].map(|rays| Model { scene: self, rays, costs: *costs });
        let paid = |tree: Tree| oracle.paid(&tree);
        SmallBound {
            greedy_by_areas: paid(greedy(&self.lattice, &areas)),
            optimal_by_areas: paid(optimal(&self.lattice, &areas)),
            greedy_by_rays: paid(greedy(&self.lattice, &rays)),
            optimal_by_rays: paid(optimal(&self.lattice, &rays)),
            greedy_by_oracle: paid(greedy(&self.lattice, &oracle)),
            optimal_by_oracle: paid(optimal(&self.lattice, &oracle)),
        }
    }
}

/// Prices by areas, or by some rays.
struct Model<'a> {
    scene: &'a SmallScene,
    rays: Option<&'a RayCounts>,
    costs: Costs,
}

impl Model<'_> {
    fn paid(&self, tree: &Tree) -> Paid {
        let whole = self.scene.lattice.whole();
        let [steps, tests] = tree.steps_and_tests(self, whole);
        let rays = self.chance(&whole).max(1.0);
        Paid { cost: tree.cost(self, whole) / rays, steps: steps / rays, tests: tests / rays }
    }
}

impl Prices for Model<'_> {
    fn chance(&self, cell: &Cell) -> f64 {
        let lattice = &self.scene.lattice;
        self.rays.map_or_else(|| lattice.area(cell), |rays| rays.of(lattice, cell) as f64)
    }

    fn triangles(&self, cell: &Cell) -> usize {
        self.scene.triangles.of(&self.scene.lattice, cell)
    }

    fn costs(&self) -> &Costs {
        &self.costs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::kd::LeafWidth;
    use rdh::{Mesh, Query, Ray, RayClass, RaySample};

    /// A pile of slanted triangles.
    fn mesh() -> Mesh {
        let at =
            |i: u32, k: u32| [(i * 7 % 11) as f32 + k as f32, (i * 5 % 13) as f32, (i * 3 % 7) as f32 + 0.5 * k as f32];
        let positions = (0..24).flat_map(|i| [at(i, 0), at(i, 1), at(i + 3, 2)]).collect();
        Mesh::new(positions, (0..24).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
    }

    fn rays(from: f32) -> Training {
        let ray = |i: u32| {
            Ray::new([from, (i % 13) as f32, (i % 7) as f32], [1.0, 0.1 * (i % 5) as f32, 0.02 * (i % 3) as f32])
        };
        Training::from_samples(
            (0..200).map(|i| RaySample::new(ray(i), None, Query::Closest, RayClass::Other)).collect(),
        )
    }

    #[test]
    fn no_tree_is_cheaper_than_the_oracles_optimum() {
        let scene = SmallScene::new(Part::all(&mesh()), &[], 8).unwrap();
        let (training, test) = (scene.rays(&rays(-1.0)), scene.rays(&rays(-2.5)));
        for leaf in [LeafWidth::One, LeafWidth::Eight] {
            let b = scene.bound(&Costs::of(leaf), &training, &test);
            let all = [b.greedy_by_areas, b.optimal_by_areas, b.greedy_by_rays, b.optimal_by_rays, b.greedy_by_oracle];
            assert!(all.iter().all(|paid| paid.cost >= b.optimal_by_oracle.cost - 1e-9), "{b:?}");
            let same = scene.bound(&Costs::of(leaf), &test, &test);
            assert_eq!(same.optimal_by_rays, same.optimal_by_oracle);
        }
    }
}
