//! glTF 2.0, as text or as GLB: meshes and where their nodes put them, at rest or at a moment of an animation.
//!
//! Each mesh becomes a geometry and each node that shows it an instance; a skinned mesh becomes a geometry of its own,
//! bent by its joints. Dropped with a note are points and lines, all that is about appearance, morph targets, and
//! scenes other than the one to be shown first. Up is +y, as the format says.
//!
//! Of the JSON only what is needed is read (`schema.rs`), and not by the `gltf` crate, because that one has node
//! transforms in f32, takes some 300 bytes for an empty node of three, and panics on some malformed files.

mod accessor;
mod animation;
mod base64;
mod budget;
mod buffers;
mod container;
mod mesh;
mod pose;
mod schema;
mod skin;

use std::collections::BTreeMap;

use self::accessor::Accessor;
use self::budget::Budget;
use self::buffers::Buffers;
use self::mesh::Primitive;
use self::pose::Pose;
use self::schema::Root;
use self::skin::{Bindings, Joints};
use super::Context;
use super::assemble::Part;
use super::notes::Notes;
use super::origin::{self, Bounds};
use crate::error::Result;
use crate::scene::{Geometry, Instance, Scene, Transform};

/// A document and its data.
struct Document<'a> {
    root: Root,
    buffers: Buffers<'a>,
    budget: Budget,
}

impl Document<'_> {
    fn accessor(&self, index: u32) -> Result<Accessor<'_>> {
        accessor::open(self, index)
    }
}

/// Reads a glTF or GLB file. Buffers may lie in files beneath the context's folder.
///
/// # Errors
/// Malformed JSON, data that doesn't exist or fit, nodes that don't form trees, and so on; naming the byte, the
/// JSON's line, or the node, mesh, accessor or buffer.
pub(super) fn read(bytes: &[u8], context: &Context) -> Result<Scene> {
    let budget = Budget::of(bytes.len());
    let (json, chunk) = container::split(bytes)?;
    let root = container::parse(json, &budget)?;
    let buffers = Buffers::new(root.buffers.len(), chunk, context.folder);
    let document = Document { root, buffers, budget };
    let changes = match context.time_secs {
        Some(secs) => animation::sample(&document, 0, secs)?,
        None => BTreeMap::new(),
    };
    let pose = pose::place(&document.root, &changes)?;
    let mut builder = Builder {
        document: &document,
        pose: &pose,
        geometries: vec![Shown::Not; document.root.meshes.len()],
        joints: BTreeMap::new(),
        scene: Scene { up: [0.0, 1.0, 0.0], ..Scene::default() },
        notes: Notes::default(),
    };
    builder.nodes()?;
    builder.finish(context)
}

/// What has become of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    /// No node has shown it so far.
    Not,
    /// It has no triangle.
    Empty,
    /// It is this geometry of the scene.
    As(usize),
    /// Only skinned nodes have shown it.
    Skinned,
}

struct Builder<'d, 'a> {
    document: &'d Document<'a>,
    pose: &'d Pose,
    /// For each mesh.
    geometries: Vec<Shown>,
    /// Of the skins so far.
    joints: BTreeMap<u32, Joints>,
    scene: Scene,
    notes: Notes,
}

impl Builder<'_, '_> {
    fn nodes(&mut self) -> Result<()> {
        for &node in &self.pose.shown {
            let about = &self.document.root.nodes[node as usize];
            let Some(mesh) = about.mesh else { continue };
            let world_from_node = self.pose.world(node)?;
            match about.skin {
                None => self.instance(mesh, world_from_node),
                Some(skin) => self.skinned(mesh, skin, world_from_node),
            }
            .map_err(|e| e.within(format_args!("node {node}")))?;
        }
        Ok(())
    }

    /// Shows a mesh, reading it if it is shown for the first time.
    fn instance(&mut self, mesh: u32, scene_from_object: Transform) -> Result<()> {
        let shown = self.geometries.get(mesh as usize).copied().unwrap_or(Shown::Not);
        let geometry = match shown {
            Shown::Empty => return Ok(()),
            Shown::As(geometry) => geometry,
            Shown::Not | Shown::Skinned => {
                let part = mesh::part(self.document, mesh, &mut self.notes, &mut |_, _, position| Ok(position))?;
                let empty = part.triangles.is_empty();
                self.geometries[mesh as usize] =
                    if empty { Shown::Empty } else { Shown::As(self.scene.geometries.len()) };
                if empty {
                    return Ok(());
                }
                self.geometry(part, [0.0; 3])?
            }
        };
        self.scene.instances.push(Instance { geometry, scene_from_object });
        Ok(())
    }

    /// Shows a mesh as its skin bends it. Vertices without joints go where the node is.
    fn skinned(&mut self, mesh: u32, skin: u32, world_from_node: Transform) -> Result<()> {
        let (document, pose) = (self.document, self.pose);
        let joints = match self.joints.entry(skin) {
            std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
            std::collections::btree_map::Entry::Vacant(new) => new.insert(Joints::of(document, skin, pose)?),
        };
        let mut bindings: Option<(String, Bindings)> = None;
        let mut loose = 0;
        let mut bend = |primitive: &Primitive, vertex: usize, position| {
            if bindings.as_ref().is_none_or(|(place, _)| *place != primitive.place) {
                bindings = Some((primitive.place.clone(), Bindings::of(document, primitive)?));
            }
            let Some((_, bindings)) = &bindings else { return Ok(position) };
            let bent = joints.skinned(bindings, vertex, position)?;
            loose += usize::from(bent.is_none());
            Ok(bent.unwrap_or_else(|| world_from_node.point(position)))
        };
        let part = mesh::part(document, mesh, &mut self.notes, &mut bend)?;
        self.notes.add("vertices of skinned meshes without a joint", loose);
        if let Some(shown @ Shown::Not) = self.geometries.get_mut(mesh as usize) {
            *shown = Shown::Skinned;
        }
        if part.triangles.is_empty() {
            return Ok(());
        }
        let origin = origin::choose(&Bounds::of(&part.positions));
        let geometry = self.geometry(part, origin)?;
        self.scene.instances.push(Instance { geometry, scene_from_object: Transform::translation(origin) });
        Ok(())
    }

    fn geometry(&mut self, part: Part, origin: [f64; 3]) -> Result<usize> {
        let positions = origin::relative(&part.positions, origin)?;
        self.scene.geometries.push(Geometry { name: part.name, positions, triangles: part.triangles, material: 0 });
        Ok(self.scene.geometries.len() - 1)
    }

    fn finish(mut self, context: &Context) -> Result<Scene> {
        let root = &self.document.root;
        let (notes, moving) = (&mut self.notes, context.time_secs.is_some());
        notes.add(
            "meshes that no node of the scene shows",
            self.geometries.iter().filter(|&&s| s == Shown::Not).count(),
        );
        notes.add("nodes outside the scene", root.nodes.len() - self.pose.shown.len());
        notes.add("scenes other than the first shown", root.scenes.len().saturating_sub(1));
        notes.add("animations not shown", root.animations.len().saturating_sub(moving.into()));
        notes.add("materials", root.materials.len());
        notes.add("textures", root.textures.len());
        notes.add("images", root.images.len());
        notes.add("cameras", root.cameras.len());
        for name in root.extensions_used.0.iter().filter(|name| *name != "KHR_mesh_quantization") {
            notes.add(&format!("what extension {name} adds"), 1);
        }
        self.scene.notes = self.notes.finish();
        origin::settle(&mut self.scene)?;
        Ok(self.scene)
    }
}

#[cfg(test)]
mod tests;
