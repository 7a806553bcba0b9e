//! Where nodes stand: their own transforms, and those of the tree.

use std::collections::BTreeMap;

use super::animation::Change;
use super::schema::{Node, Root};
use crate::error::{Error, Result};
use crate::formats::grow;
use crate::scene::Transform;

/// The nodes, placed.
pub(super) struct Pose {
    /// For each node; `None` if it hangs on a cycle.
    pub world_from_node: Vec<Option<Transform>>,
    /// The nodes of the scene, parents before children, in the order of the document.
    pub shown: Vec<u32>,
}

impl Pose {
    /// The transform of a node that something refers to.
    pub(super) fn world(&self, node: u32) -> Result<Transform> {
        let reason = |reason| Error::at(format!("node {node}"), reason);
        let found = self.world_from_node.get(node as usize).ok_or_else(|| reason("does not exist"))?;
        found.ok_or_else(|| reason("is part of a cycle"))
    }
}

/// Places all nodes and finds those of the scene. The walk has its own stack, so that depth is no matter.
///
/// # Errors
/// Nodes that don't form trees, or transforms that aren't affine.
pub(super) fn place(root: &Root, changes: &BTreeMap<u32, Change>) -> Result<Pose> {
    let parents = parents(&root.nodes)?;
    let mut walk = Walk { nodes: &root.nodes, changes, stack: Vec::new(), world: filled(None, root.nodes.len())? };
    let mut pose = Vec::new();
    for scene_root in scene_roots(root, &parents)? {
        walk.tree(scene_root, &mut pose)?;
    }
    // Joints may lie outside the scene: the other trees are placed, but not shown.
    let orphans = (0..root.nodes.len()).filter(|&n| parents[n].is_none() && walk.world[n].is_none());
    for orphan in orphans.collect::<Vec<_>>() {
        walk.tree(orphan as u32, &mut Vec::new())?;
    }
    Ok(Pose { world_from_node: walk.world, shown: pose })
}

/// Each node's parent. Since a node has at most one, a walk that starts at nodes without a parent meets none twice.
fn parents(nodes: &[Node]) -> Result<Vec<Option<u32>>> {
    let mut parents = filled(None, nodes.len())?;
    for (node, children) in nodes.iter().map(|n| &n.children).enumerate() {
        for &child in children {
            let of = |reason: String| Error::at(format!("node {node}"), reason);
            let parent: &mut Option<u32> =
                parents.get_mut(child as usize).ok_or_else(|| of(format!("child {child} does not exist")))?;
            if let Some(other) = parent.replace(node as u32) {
                return Err(of(format!("child {child} is already one of node {other}; nodes must form trees")));
            }
        }
    }
    Ok(parents)
}

/// The scene's roots: of the scene that is to be shown first, or all roots if the document has no scene.
fn scene_roots(root: &Root, parents: &[Option<u32>]) -> Result<Vec<u32>> {
    let number = root.scene.unwrap_or(0);
    let Some(scene) = root.scenes.get(number as usize) else {
        return match root.scene {
            Some(_) => Err(Error::at(format!("scene {number}"), "does not exist")),
            None => Ok((0..).zip(parents).filter(|(_, parent)| parent.is_none()).map(|(node, _)| node).collect()),
        };
    };
    for &node in &scene.nodes {
        let reason = match parents.get(node as usize) {
            None => "does not exist".to_owned(),
            Some(Some(parent)) => format!("can't be a root of the scene: it is a child of node {parent}"),
            Some(None) => continue,
        };
        return Err(Error::at(format!("node {node}"), reason));
    }
    Ok(scene.nodes.clone())
}

struct Walk<'a> {
    nodes: &'a [Node],
    changes: &'a BTreeMap<u32, Change>,
    /// Nodes still to be placed; their parents are.
    stack: Vec<(u32, Option<u32>)>,
    world: Vec<Option<Transform>>,
}

impl Walk<'_> {
    /// Places a tree, appending its nodes to a list.
    fn tree(&mut self, root: u32, order: &mut Vec<u32>) -> Result<()> {
        grow::push(&mut self.stack, (root, None))?;
        while let Some((node, parent)) = self.stack.pop() {
            let local = local(&self.nodes[node as usize], self.changes.get(&node))
                .map_err(|reason| Error::at(format!("node {node}"), reason))?;
            let world = match parent.and_then(|parent| self.world[parent as usize]) {
                Some(parent) => parent.after(&local),
                None => local,
            };
            if self.world[node as usize].replace(world).is_some() {
                return Err(Error::at(format!("node {node}"), "is a root of the scene twice"));
            }
            grow::push(order, node)?;
            for &child in self.nodes[node as usize].children.iter().rev() {
                grow::push(&mut self.stack, (child, Some(node)))?;
            }
        }
        Ok(())
    }
}

/// A node's own transform: its matrix, or translation, rotation and scale, which an animation may change.
fn local(node: &Node, change: Option<&Change>) -> Result<Transform, String> {
    let transform = match (&node.matrix, change) {
        (Some(_), Some(_)) => return Err("has a matrix, and so can't be animated".to_owned()),
        (Some(matrix), None) => from_matrix(matrix)?,
        (None, change) => {
            let change = change.copied().unwrap_or_default();
            let translation = change.translation.or(node.translation.as_deref().copied()).unwrap_or_default();
            let rotation = change.rotation.or(node.rotation.as_deref().copied()).unwrap_or([0.0, 0.0, 0.0, 1.0]);
            let scale = change.scale.or(node.scale.as_deref().copied()).unwrap_or([1.0; 3]);
            from_parts(translation, rotation, scale)?
        }
    };
    if transform.0.iter().flatten().all(|x| x.is_finite()) {
        Ok(transform)
    } else {
        Err("its transform is not finite".to_owned())
    }
}

fn from_matrix(columns: &[f64; 16]) -> Result<Transform, String> {
    let row = |r: usize| [columns[r], columns[4 + r], columns[8 + r], columns[12 + r]];
    if row(3) == [0.0, 0.0, 0.0, 1.0] {
        Ok(Transform([row(0), row(1), row(2)]))
    } else {
        Err(format!("its matrix is not affine: the last row is {:?}", row(3)))
    }
}

/// First scale, then rotate by a quaternion (x, y, z, w; of whatever length), then translate.
fn from_parts(t: [f64; 3], rotation: [f64; 4], s: [f64; 3]) -> Result<Transform, String> {
    let length = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!("its rotation {rotation:?} is not a quaternion of unit length"));
    }
    let [x, y, z, w] = rotation.map(|q| q / length);
    let rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    Ok(Transform([0, 1, 2].map(|r| [rows[r][0] * s[0], rows[r][1] * s[1], rows[r][2] * s[2], t[r]])))
}

fn filled<T: Copy>(value: T, count: usize) -> Result<Vec<T>> {
    let mut list = Vec::new();
    grow::reserve(&mut list, count)?;
    list.resize(count, value);
    Ok(list)
}
