//! Several scenes as one.

use super::{notes::Notes, origin};
use crate::error::Result;
use crate::scene::{Scene, Transform};

/// Joins scenes, in order. One scene stays as it is; several get the origin that suits them together.
///
/// # Errors
/// The first error among the scenes; or scenes so far apart that f32 can't hold them.
pub(super) fn join(scenes: impl Iterator<Item = Result<Scene>>) -> Result<Scene> {
    let mut joined: Option<Scene> = None;
    let mut several = false;
    for scene in scenes {
        joined = Some(match joined {
            None => scene?,
            Some(mut first) => {
                if !several {
                    in_world(&mut first);
                    several = true;
                }
                append(&mut first, scene?);
                first
            }
        });
    }
    let mut joined = joined.unwrap_or_default();
    if several {
        origin::settle(&mut joined)?;
    }
    Ok(joined)
}

/// Makes a scene's origin `[0, 0, 0]`, its instances carrying the offset.
fn in_world(scene: &mut Scene) {
    if scene.origin != [0.0; 3] {
        let there = Transform::translation(scene.origin);
        scene.instances.iter_mut().for_each(|i| i.scene_from_object = there.after(&i.scene_from_object));
        scene.origin = [0.0; 3];
    }
}

fn append(joined: &mut Scene, mut scene: Scene) {
    in_world(&mut scene);
    let first = joined.geometries.len();
    joined.geometries.append(&mut scene.geometries);
    joined
        .instances
        .extend(scene.instances.iter().map(|i| crate::scene::Instance { geometry: first + i.geometry, ..*i }));
    joined.name = format!("{}+{}", joined.name, scene.name);
    let mut notes = Notes::default();
    for note in joined.notes.iter().chain(&scene.notes) {
        notes.add(&note.what, note.count);
    }
    joined.notes = notes.finish();
}
