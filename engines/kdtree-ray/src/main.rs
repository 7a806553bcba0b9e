//! The crate kdtree-ray as a competitor. It gives all triangles whose leaves a ray crosses, in no order; they are tested here.

use std::process::ExitCode;

use anyhow::Result;
use cgmath::Vector3;
use kdtree_ray::{AABB, Bounded, KDTree};
use rdh_engine_protocol::{Built, Engine, Mesh, Ray, Triangle, memory};

/// Cargo.toml asks for this one.
const VERSION: &str = "1.2.2";

struct Candidates {
    tree: KDTree,
    shapes: Vec<Shape>,
    /// The crate doesn't say it: what the process has grown by.
    tree_bytes: usize,
}

struct Shape(Triangle);

fn main() -> ExitCode {
    rdh_engine_protocol::serve::<Candidates>()
}

impl Bounded for Shape {
    fn bound(&self) -> AABB {
        let [a, b, c] = self.0.corners();
        let bound = |f: fn(f32, f32) -> f32| Vector3::from(std::array::from_fn(|axis| f(f(a[axis], b[axis]), c[axis])));
        AABB::new(bound(f32::min), bound(f32::max))
    }
}

impl Engine for Candidates {
    const NAME: &'static str = "kdtree-ray";

    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>> {
        anyhow::ensure!(mode == "default", "unknown mode '{mode}'; known: default");
        anyhow::ensure!(!mesh.triangles.is_empty(), "the crate takes no empty mesh");
        let shapes: Vec<_> = mesh.corners().map(|corners| Shape(Triangle::new(corners))).collect();
        drop(mesh);
        let before = memory::resident_bytes();
        let build = || {
            let tree = KDTree::build(&shapes);
            Self { tree, shapes, tree_bytes: memory::resident_bytes().saturating_sub(before) }
        };
        Ok(Built::time(VERSION, build, |built| built.tree_bytes + size_of::<Shape>() * built.shapes.len()))
    }

    fn closest(&self, ray: &Ray) -> f32 {
        let mut nearest = f32::INFINITY;
        for i in self.candidates(ray) {
            nearest = self.shapes[i].0.hit(ray, nearest.min(ray.t_max)).min(nearest);
        }
        nearest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.candidates(ray).into_iter().any(|i| self.shapes[i].0.hit(ray, ray.t_max) < f32::INFINITY)
    }
}

impl Candidates {
    fn candidates(&self, ray: &Ray) -> Vec<usize> {
        self.tree.intersect(&ray.origin.into(), &ray.direction.into())
    }
}
