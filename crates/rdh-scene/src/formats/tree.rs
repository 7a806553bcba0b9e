//! `.rdh`: a saved tree. Its mesh is the scene; where its settings say so, with an origin and views.

use super::Context;
use super::notes::Notes;
use crate::error::Result;
use crate::saved::Setting;
use crate::scene::{Geometry, Instance, Scene, Transform};

/// Reads the mesh of a saved tree.
///
/// # Errors
/// What `rdh::saved` says, naming the byte.
pub(super) fn read(bytes: &[u8], _: &Context) -> Result<Scene> {
    let (mesh, provenance) = rdh::saved::read_mesh(bytes)?;
    let geometry =
        Geometry { positions: mesh.positions().to_vec(), triangles: mesh.triangles().to_vec(), ..Geometry::default() };
    let mut notes = Notes::default();
    if mesh.masks().is_some() {
        notes.add("masks of triangles", mesh.len());
    }
    let scene = Scene {
        notes: notes.finish(),
        geometries: vec![geometry],
        instances: vec![Instance { geometry: 0, scene_from_object: Transform::IDENTITY }],
        up: [0.0, 0.0, 1.0],
        ..Scene::default()
    };
    Ok(match Setting::from_settings(&provenance.settings) {
        Some(Setting { id: _, origin, up, views }) => Scene { origin, up, views, ..scene },
        None => scene,
    })
}
