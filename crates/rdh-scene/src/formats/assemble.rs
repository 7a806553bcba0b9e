//! A scene out of parts that all stand where their coordinates say: what OBJ, PLY and STL hold.

use rdh::Mesh;

use super::origin::{self, Bounds};
use crate::error::{Error, Result};
use crate::scene::{Geometry, Instance, Note, Scene, Transform};

/// A mesh as it was read.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Its name in the source, or empty.
    pub name: String,
    /// Vertices, finite and within the range of f32.
    pub positions: Vec<[f64; 3]>,
    /// Vertex indices, in range.
    pub triangles: Vec<[u32; 3]>,
}

/// Puts parts into one scene, with the origin that suits them together.
///
/// # Errors
/// More vertices or triangles than can be numbered, or memory running out.
pub(super) fn assemble(parts: Vec<Part>, up: [f64; 3], notes: Vec<Note>) -> Result<Scene> {
    limit("vertices", parts.iter().map(|p| p.positions.len()).sum(), u32::MAX as usize)?;
    limit("triangles", parts.iter().map(|p| p.triangles.len()).sum(), Mesh::MAX_TRIANGLES)?;
    let origin = origin::choose(&Bounds::of(parts.iter().flat_map(|p| &p.positions)));
    let mut scene = Scene { up, origin, notes, ..Scene::default() };
    for part in parts.into_iter().filter(|p| !p.triangles.is_empty()) {
        let positions = origin::relative(&part.positions, origin)?;
        let geometry = scene.geometries.len();
        scene.geometries.push(Geometry { name: part.name, positions, triangles: part.triangles, material: 0 });
        scene.instances.push(Instance { geometry, scene_from_object: Transform::IDENTITY });
    }
    Ok(scene)
}

fn limit(what: &str, count: usize, most: usize) -> Result<()> {
    if count > most {
        Err(Error::whole(format!("{count} {what}: more than the {most} that can be numbered")))
    } else {
        Ok(())
    }
}
