//! The triangles of a mesh, whatever its primitives are.

use super::Document;
use super::accessor::Accessor;
use super::schema::{self, Shape};
use crate::error::{Error, Result};
use crate::formats::assemble::Part;
use crate::formats::notes::Notes;
use crate::formats::{grow, text};

/// Moves a vertex: given its primitive, its number there and where it is in the mesh.
pub(super) type Move<'f> = dyn FnMut(&Primitive, usize, [f64; 3]) -> Result<[f64; 3]> + 'f;

/// A primitive of triangles, opened.
pub(super) struct Primitive<'a> {
    pub about: &'a schema::Primitive,
    /// "mesh 2, primitive 0".
    pub place: String,
    positions: Accessor<'a>,
    indices: Option<Accessor<'a>>,
    mode: Mode,
}

#[derive(Debug, Clone, Copy)]
enum Mode {
    List,
    Strip,
    Fan,
}

/// All triangles of a mesh, as one part, each vertex moved by `to`.
///
/// # Errors
/// Data that doesn't exist or fit, indices out of range, coordinates that aren't finite, by mesh and primitive.
pub(super) fn part(document: &Document, mesh: u32, notes: &mut Notes, to: &mut Move) -> Result<Part> {
    let about = document.root.meshes.get(mesh as usize);
    let about = about.ok_or_else(|| Error::at(format!("mesh {mesh}"), "does not exist"))?;
    let mut part = Part { name: about.name.clone(), ..Part::default() };
    for (number, primitive) in about.primitives.iter().enumerate() {
        let place = format!("mesh {mesh}, primitive {number}");
        if let Some(primitive) = Primitive::open(document, primitive, place, notes)? {
            primitive.append(document, &mut part, notes, to)?;
        }
    }
    Ok(part)
}

impl<'a> Primitive<'a> {
    /// Opens a primitive; `None` if it has no triangles to read, which is noted.
    fn open(
        document: &'a Document,
        about: &'a schema::Primitive,
        place: String,
        notes: &mut Notes,
    ) -> Result<Option<Self>> {
        let mode = match about.mode.unwrap_or(4) {
            0 => return dropped(notes, "primitives of points"),
            1..=3 => return dropped(notes, "primitives of lines"),
            4 => Mode::List,
            5 => Mode::Strip,
            6 => Mode::Fan,
            mode => return Err(Error::at(place, format!("unknown mode {mode}"))),
        };
        let Some(&positions) = about.attributes.get("POSITION") else {
            return dropped(notes, "primitives without positions");
        };
        let named = |e: Error| e.within(&place);
        let positions = document.accessor(positions).map_err(named)?;
        if positions.shape != Shape::Vec3 {
            return Err(Error::at(place, "positions must be of type VEC3"));
        }
        let indices = about.indices.map(|indices| document.accessor(indices)).transpose().map_err(named)?;
        if indices.is_some_and(|i| i.shape != Shape::Scalar || !i.component.is_unsigned() || i.normalized) {
            return Err(Error::at(place, "indices must be plain unsigned integers"));
        }
        notes.add("vertex attributes other than positions and joints", other_attributes(about));
        notes.add("morph targets", about.targets.len());
        Ok(Some(Self { about, place, positions, indices, mode }))
    }

    fn append(&self, document: &Document, part: &mut Part, notes: &mut Notes, to: &mut Move) -> Result<()> {
        let triangles = self.triangle_count(notes);
        document.budget.spend(triangles as u64, 24, &self.place)?;
        let kept = self.kept_vertices(document)?;
        let count = kept.as_ref().map_or(self.positions.count, Vec::len);
        document.budget.spend(count as u64, 48, &self.place)?;
        let first = u32::try_from(part.positions.len() + count).ok().map(|_| part.positions.len() as u32);
        let first = first.ok_or_else(|| Error::at(&*self.place, "more vertices than can be numbered"))?;
        grow::reserve(&mut part.positions, count)?;
        for nth in 0..count {
            part.positions.push(self.position(kept.as_ref().map_or(nth, |kept| kept[nth] as usize), to)?);
        }
        grow::reserve(&mut part.triangles, triangles)?;
        for triangle in 0..triangles {
            let [a, b, c] = self.corners(triangle).map(|corner| self.vertex(corner, kept.as_deref()));
            part.triangles.push([first + a?, first + b?, first + c?]);
        }
        Ok(())
    }

    /// How many vertices it has.
    pub(super) fn vertex_count(&self) -> usize {
        self.positions.count
    }

    fn corner_count(&self) -> usize {
        self.indices.map_or(self.positions.count, |indices| indices.count)
    }

    fn triangle_count(&self, notes: &mut Notes) -> usize {
        let corners = self.corner_count();
        let triangles = match self.mode {
            Mode::List => corners / 3,
            Mode::Strip | Mode::Fan => corners.saturating_sub(2),
        };
        let left = match self.mode {
            Mode::List => corners % 3,
            Mode::Strip | Mode::Fan => {
                if triangles == 0 {
                    corners
                } else {
                    0
                }
            }
        };
        notes.add("corners that make no triangle", left);
        triangles
    }

    /// The corners of a triangle, as in section 3.7.2.1 of the glTF 2.0 specification.
    fn corners(&self, triangle: usize) -> [usize; 3] {
        match self.mode {
            Mode::List => [3 * triangle, 3 * triangle + 1, 3 * triangle + 2],
            Mode::Strip => [triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2],
            Mode::Fan => [triangle + 1, triangle + 2, 0],
        }
    }

    /// The vertices to keep, if not all: many primitives may share one list of vertices, each using a few of it.
    fn kept_vertices(&self, document: &Document) -> Result<Option<Vec<u32>>> {
        let corners = self.corner_count();
        if self.positions.count <= corners.saturating_mul(2).saturating_add(64) {
            return Ok(None);
        }
        document.budget.spend(corners as u64, 4, &self.place)?;
        let mut kept = Vec::new();
        grow::reserve(&mut kept, corners)?;
        for corner in 0..corners {
            kept.push(self.vertex(corner, None)?);
        }
        kept.sort_unstable();
        kept.dedup();
        Ok(Some(kept))
    }

    /// The vertex at a corner: its number among those that are kept.
    fn vertex(&self, corner: usize, kept: Option<&[u32]>) -> Result<u32> {
        let vertex = match self.indices {
            Some(indices) => indices.get::<1>(corner)[0] as u32,
            None => corner as u32,
        };
        if vertex as usize >= self.positions.count {
            let reason = format!("vertex index {vertex} is out of range (there are {})", self.positions.count);
            return Err(Error::at(format!("{}, index {corner}", self.place), reason));
        }
        Ok(kept.map_or(vertex, |kept| kept.partition_point(|&k| k < vertex) as u32))
    }

    fn position(&self, vertex: usize, to: &mut Move) -> Result<[f64; 3]> {
        let here = |reason: String| Error::at(format!("{}, vertex {vertex}", self.place), reason);
        let position = self.positions.get::<3>(vertex);
        position.iter().try_for_each(|&x| text::in_range(x).map(drop)).map_err(here)?;
        let moved = to(self, vertex, position).map_err(|e| e.within(&self.place))?;
        moved.iter().try_for_each(|&x| text::in_range(x).map(drop)).map_err(here)?;
        Ok(moved)
    }
}

fn dropped<T>(notes: &mut Notes, what: &str) -> Result<Option<T>> {
    notes.add(what, 1);
    Ok(None)
}

fn other_attributes(primitive: &schema::Primitive) -> usize {
    let is_read = |name: &str| name == "POSITION" || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
    primitive.attributes.keys().filter(|name| !is_read(name)).count()
}
