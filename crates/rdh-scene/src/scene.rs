//! What a scene is: geometries, where they stand, what they are made of, and who looks at them.

use rdh::{Mesh, Vec3};

use crate::camera::View;
use crate::error::Result;
use crate::formats;

/// A scene. Positions are relative to `origin`, so that f32 is fine enough even for geodata.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Its id in reports.
    pub name: String,
    /// The meshes, each in its own space.
    pub geometries: Vec<Geometry>,
    /// Where they stand. A geometry without an instance is not in the scene.
    pub instances: Vec<Instance>,
    /// What surfaces are made of; geometries refer to it. Empty where the source says nothing.
    pub materials: Vec<Material>,
    /// Point lights. Empty where the source says nothing.
    pub lights: Vec<PointLight>,
    /// Named views, in world coordinates (`origin` not subtracted).
    pub views: Vec<View>,
    /// Which direction is up.
    pub up: [f64; 3],
    /// What `[0, 0, 0]` of the instances' space is in world coordinates.
    pub origin: [f64; 3],
    /// What was dropped or repaired on the way in.
    pub notes: Vec<Note>,
}

/// How a scene occludes itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Objects before a background.
    Open,
    /// Seen from inside, most of it visible.
    Interior,
    /// Nearly all of it hidden from any one point.
    Dense,
}

impl Kind {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::Open, Self::Interior, Self::Dense];
}

/// A mesh in its own space.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Geometry {
    /// Its name in the source, or empty.
    pub name: String,
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Index into the scene's materials; ignored where there are none.
    pub material: usize,
}

impl Geometry {
    fn zero_area_count(&self) -> usize {
        let corner = |i: u32| self.positions[i as usize].map(f64::from);
        self.triangles.iter().filter(|t| is_flat(t.map(corner))).count()
    }
}

/// A geometry that stands somewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into the scene's geometries.
    pub geometry: usize,
    /// How it stands.
    pub scene_from_object: Transform,
}

/// An affine transform: three rows of four, the last column is the translation. May mirror.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform(pub [[f64; 4]; 3]);

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    /// Moves by a vector.
    pub fn translation(by: [f64; 3]) -> Self {
        let mut t = Self::IDENTITY;
        for (row, x) in t.0.iter_mut().zip(by) {
            row[3] = x;
        }
        t
    }

    /// Where a point goes.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3])
    }

    /// First `inner`, then this one.
    pub fn after(&self, inner: &Self) -> Self {
        Self(self.0.map(|r| {
            let column = |c: usize| (0..3).map(|k| r[k] * inner.0[k][c]).sum::<f64>();
            [column(0), column(1), column(2), column(3) + r[3]]
        }))
    }

    /// Whether it turns left hands into right ones.
    pub fn mirrors(&self) -> bool {
        let [a, b, c] = self.0;
        let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        determinant < 0.0
    }
}

/// What a surface does to light; enough for the studies' rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Diffuse reflectance, 0 to 1.
    pub diffuse: f32,
    /// Mirror reflectance, 0 to 1.
    pub mirror: f32,
    /// Transmittance, 0 to 1.
    pub transmission: f32,
    /// Index of refraction of the inside.
    pub index: f32,
}

impl Material {
    /// Plain diffuse 0.8.
    pub const DIFFUSE: Self = Self { diffuse: 0.8, mirror: 0.0, transmission: 0.0, index: 1.0 };
}

/// A point light, in world coordinates (`origin` not subtracted).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLight {
    /// Where it is.
    pub position: [f64; 3],
}

/// Something a reader dropped or repaired: never silently.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Note {
    /// What, in words: "lines without a face", "textures".
    pub what: String,
    /// How many of them.
    pub count: usize,
}

/// A scene as one mesh, with the way back to its parts.
#[derive(Debug, Clone, Default)]
pub struct Flat {
    /// All triangles, relative to the scene's origin, instance by instance.
    pub mesh: Mesh,
    /// For each instance, its first triangle; and at the end the number of triangles.
    pub first_triangle: Vec<u32>,
    /// For each instance, its material's index.
    pub material: Vec<usize>,
}

impl Flat {
    /// Which instance a triangle belongs to. O(log n).
    pub fn instance_of(&self, tri: rdh::TriId) -> usize {
        self.first_triangle.partition_point(|&first| first <= tri.0) - 1
    }
}

impl Scene {
    /// A scene of one mesh; far away ones get an origin near them, as those from files do.
    ///
    /// # Errors
    /// More vertices or triangles than can be numbered, or memory running out. Vertices and indices are not checked yet.
    pub fn from_triangles(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        formats::place(positions, triangles)
    }

    /// Triangles of all instances.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.geometries[i.geometry].triangles.len()).sum()
    }

    /// Triangles of exactly zero area, all instances counted. They stay in the scene; no ray hits them.
    pub fn zero_area_count(&self) -> usize {
        let flat: Vec<usize> = self.geometries.iter().map(Geometry::zero_area_count).collect();
        self.instances.iter().map(|i| flat[i.geometry]).sum()
    }

    /// All instances as one mesh. A mirrored instance keeps its outside outside: its triangles are turned round.
    ///
    /// # Errors
    /// What [`Mesh::new`] says, numbered in the flat mesh.
    pub fn flatten(&self) -> rdh::Result<Flat> {
        let (mut positions, mut triangles) = (Vec::new(), Vec::with_capacity(self.triangle_count()));
        let mut flat = Flat::default();
        for instance in &self.instances {
            let geometry = &self.geometries[instance.geometry];
            let transform = &instance.scene_from_object;
            let base = positions.len() as u32;
            let keep = *transform == Transform::IDENTITY;
            let place = |p: &Vec3| if keep { *p } else { transform.point(p.map(f64::from)).map(|x| x as f32) };
            positions.extend(geometry.positions.iter().map(place));
            flat.first_triangle.push(triangles.len() as u32);
            flat.material.push(geometry.material);
            let turned = transform.mirrors();
            let turn = |t: &[u32; 3]| if turned { [t[0], t[2], t[1]] } else { *t };
            triangles.extend(geometry.triangles.iter().map(|t| turn(t).map(|i| i.saturating_add(base))));
        }
        flat.first_triangle.push(triangles.len() as u32);
        flat.mesh = Mesh::new(positions, triangles)?;
        Ok(flat)
    }
}

/// Whether the cross product of two sides is zero. In f64, its products of f32 differences are practically exact.
fn is_flat([a, b, c]: [[f64; 3]; 3]) -> bool {
    let side = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v) = (side(b), side(c));
    u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_on_a_line_have_no_area() {
        let geometry = Geometry {
            positions: vec![[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0], [1.0, 0.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 1, 1], [0, 1, 3], [3, 3, 3]],
            ..Geometry::default()
        };
        assert_eq!(geometry.zero_area_count(), 3);
    }
}
