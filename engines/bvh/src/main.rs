//! The crate bvh as a competitor. It is a hierarchy of boxes: the triangles are ours.
//!
//! It has no query for the closest hit. Its iterator gives shapes in the order in which a ray enters their boxes, so the
//! search ends at the first box that begins behind the nearest hit.

use std::process::ExitCode;

use anyhow::Result;
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray as BvhRay;
use nalgebra::{Point3, Vector3};
use rdh_engine_protocol::{Built, Engine, Mesh, Ray, Triangle};

/// Cargo.toml asks for this one.
const VERSION: &str = "0.13.0";

struct Boxes {
    tree: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

struct Shape {
    triangle: Triangle,
    bounds: Aabb<f32, 3>,
    node: usize,
}

fn main() -> ExitCode {
    rdh_engine_protocol::serve::<Boxes>()
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.bounds
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Engine for Boxes {
    const NAME: &'static str = "bvh";

    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>> {
        anyhow::ensure!(mode == "default", "unknown mode '{mode}'; known: default");
        let mut shapes: Vec<_> = mesh.corners().map(Shape::new).collect();
        drop(mesh);
        let build = || Self { tree: Bvh::build(&mut shapes), shapes };
        Ok(Built::time(VERSION, build, Self::bytes))
    }

    fn closest(&self, ray: &Ray) -> f32 {
        let (boxed, length) = bvh_ray(ray);
        let mut nearest = ray.t_max;
        let mut found = f32::INFINITY;
        for shape in self.tree.nearest_traverse_iterator(&boxed, &self.shapes) {
            let entry = boxed.intersection_slice_for_aabb(&shape.bounds).map_or(0.0, |(entry, _)| entry);
            if entry > nearest * length {
                break;
            }
            let t = shape.triangle.hit(ray, nearest);
            if t < f32::INFINITY {
                (nearest, found) = (t, t);
            }
        }
        found
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let (boxed, _) = bvh_ray(ray);
        let mut shapes = self.tree.traverse_iterator(&boxed, &self.shapes);
        shapes.any(|shape| shape.triangle.hit(ray, ray.t_max) < f32::INFINITY)
    }
}

impl Boxes {
    fn bytes(&self) -> usize {
        size_of::<BvhNode<f32, 3>>() * self.tree.nodes.len() + size_of::<Shape>() * self.shapes.len()
    }
}

impl Shape {
    fn new(corners: [[f32; 3]; 3]) -> Self {
        let [a, b, c] = corners.map(Point3::from);
        let bounds = Aabb::empty().grow(&a).grow(&b).grow(&c);
        Self { triangle: Triangle::new(corners), bounds, node: 0 }
    }
}

/// The crate normalises directions: distances to its boxes are in units of space, not of the direction's length.
fn bvh_ray(ray: &Ray) -> (BvhRay<f32, 3>, f32) {
    let direction = Vector3::from(ray.direction);
    (BvhRay::new(ray.origin.into(), direction), direction.norm())
}
