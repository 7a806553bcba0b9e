//! A scene in the making.

use super::shape::Shape;
use super::vector::Point;
use crate::camera::View;
use crate::scene::{Instance, Material, PointLight, Scene, Transform};

/// Collects geometries, instances, materials and lights.
#[derive(Debug)]
pub(crate) struct Stage(Scene);

/// A geometry that can be placed many times.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prop(usize);

/// A material of the stage.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Paint(usize);

impl Stage {
    /// An empty stage.
    pub(crate) fn new(name: &str, up: Point) -> Self {
        Self(Scene { name: name.to_owned(), up, ..Scene::default() })
    }

    /// Adds a material.
    pub(crate) fn material(&mut self, material: Material) -> Paint {
        self.0.materials.push(material);
        Paint(self.0.materials.len() - 1)
    }

    /// Adds a geometry that is not in the scene until it is placed.
    pub(crate) fn prop(&mut self, name: &str, shape: Shape, paint: Paint) -> Prop {
        self.0.geometries.push(shape.geometry(name, paint.0));
        Prop(self.0.geometries.len() - 1)
    }

    /// Places a geometry once more.
    pub(crate) fn place(&mut self, prop: Prop, scene_from_object: Transform) {
        self.0.instances.push(Instance { geometry: prop.0, scene_from_object });
    }

    /// Adds a geometry that stands where it is, if it has any triangle.
    pub(crate) fn add(&mut self, name: &str, shape: Shape, paint: Paint) {
        if !shape.triangles.is_empty() {
            let prop = self.prop(name, shape, paint);
            self.place(prop, Transform::IDENTITY);
        }
    }

    /// Adds point lights.
    pub(crate) fn lights(&mut self, positions: &[Point]) {
        self.0.lights.extend(positions.iter().map(|&position| PointLight { position }));
    }

    /// The scene.
    pub(crate) fn finish(self) -> Scene {
        self.0
    }
}

/// A view.
pub(crate) fn view(name: &str, eye: Point, target: Point, up: Point, fov_y_degrees: f64) -> View {
    View { name: name.to_owned(), eye, target, up, fov_y_degrees }
}
