//! Skins: vertices that follow several joints.

use super::Document;
use super::accessor::Accessor;
use super::mesh::Primitive;
use super::pose::Pose;
use super::schema::Shape;
use crate::error::{Error, Result};
use crate::formats::grow;
use crate::scene::Transform;

/// Joints are numbered by 16 bits.
const MOST_JOINTS: usize = 1 << 16;
/// Four joints each. Files have one or two; more would only be there to keep us busy.
const MOST_SETS: usize = 16;

/// Where each joint takes a vertex of the mesh. The node of a skinned mesh doesn't matter: glTF 2.0, section 3.7.3.3.
pub(super) struct Joints {
    skin: u32,
    world_from_mesh: Vec<Transform>,
}

impl Joints {
    /// The joints of a skin in a pose.
    ///
    /// # Errors
    /// Joints or matrices that don't exist or fit, by skin.
    pub(super) fn of(document: &Document, skin: u32, pose: &Pose) -> Result<Self> {
        let reason = |reason: String| Error::at(format!("skin {skin}"), reason);
        let about = document.root.skins.get(skin as usize).ok_or_else(|| reason("does not exist".to_owned()))?;
        let count = about.joints.len();
        if count == 0 || count > MOST_JOINTS {
            return Err(reason(format!("has {count} joints; 1 to {MOST_JOINTS} are allowed")));
        }
        let named = |e: Error| e.within(format_args!("skin {skin}"));
        let matrices = about.inverse_bind_matrices.map(|index| document.accessor(index)).transpose().map_err(named)?;
        if matrices.is_some_and(|m| m.shape != Shape::Mat4 || m.count < count) {
            return Err(reason("has too few inverse bind matrices, or not of type MAT4".to_owned()));
        }
        document.budget.spend(count as u64, size_of::<Transform>() as u64, &format!("skin {skin}"))?;
        let mut world_from_mesh = Vec::new();
        grow::reserve(&mut world_from_mesh, count)?;
        for (number, &joint) in about.joints.iter().enumerate() {
            let world = pose.world(joint).map_err(named)?;
            world_from_mesh.push(match matrices {
                Some(matrices) => world.after(&affine(matrices.get(number))),
                None => world,
            });
        }
        Ok(Self { skin, world_from_mesh })
    }

    /// Whether a vertex of a primitive, which is at `position` in the mesh, has joints; and where they take it.
    pub(super) fn skinned(&self, bindings: &Bindings, vertex: usize, position: [f64; 3]) -> Result<Option<[f64; 3]>> {
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for (joints, weights) in &bindings.sets {
            let (joints, weights) = (joints.get::<4>(vertex), weights.get::<4>(vertex));
            for (joint, weight) in joints.into_iter().zip(weights).filter(|&(_, weight)| weight != 0.0) {
                let transform = self.world_from_mesh.get(joint as usize).ok_or_else(|| {
                    Error::at(format!("vertex {vertex}"), format!("joint {joint} is not one of skin {}", self.skin))
                })?;
                let there = transform.point(position);
                sum = [0, 1, 2].map(|axis| sum[axis] + weight * there[axis]);
                total += weight;
            }
        }
        // Weights should add up to 1, but as fractions of 255 they do so only nearly.
        Ok((total != 0.0).then(|| sum.map(|x| x / total)))
    }
}

/// The joints and weights of a primitive's vertices.
pub(super) struct Bindings<'a> {
    sets: Vec<(Accessor<'a>, Accessor<'a>)>,
}

impl<'a> Bindings<'a> {
    /// Opens those of a primitive; it may have none.
    ///
    /// # Errors
    /// Joints or weights of other types, or fewer of them than vertices.
    pub(super) fn of(document: &'a Document, primitive: &Primitive) -> Result<Self> {
        let mut sets = Vec::new();
        let attribute = |kind: &str, set: usize| primitive.about.attributes.get(&format!("{kind}_{set}")).copied();
        while let (Some(joints), Some(weights)) = (attribute("JOINTS", sets.len()), attribute("WEIGHTS", sets.len())) {
            let (joints, weights) = (document.accessor(joints)?, document.accessor(weights)?);
            let fits = |a: &Accessor| a.shape == Shape::Vec4 && a.count >= primitive.vertex_count();
            if !fits(&joints) || !fits(&weights) || !joints.component.is_unsigned() || sets.len() == MOST_SETS {
                return Err(Error::whole(format!(
                    "joints and weights must be four a vertex, in up to {MOST_SETS} sets"
                )));
            }
            sets.push((joints, weights));
        }
        Ok(Self { sets })
    }
}

/// A matrix by columns, without its last row, which says nothing in an affine one.
fn affine(m: [f64; 16]) -> Transform {
    Transform([0, 1, 2].map(|r| [m[r], m[4 + r], m[8 + r], m[12 + r]]))
}
