//! PLY: ascii, binary little endian and binary big endian; any types of numbers.
//!
//! Read are the `x`, `y`, `z` of element `vertex` and the list `vertex_indices` (or `vertex_index`) of element `face`,
//! in whatever order; polygons become fans. Everything else is skipped, with a note. PLY has no up direction: +z by
//! custom.
//!
//! An own reader: the crates for PLY take whatever count the header claims for memory, or don't check indices.

mod body;
mod header;

use self::body::Body;
use self::header::Element;
use super::assemble::{Part, assemble};
use super::notes::Notes;
use super::obj::Fan;
use super::{Context, grow};
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Reads a PLY file; it refers to no other.
///
/// # Errors
/// A malformed header, counts that the file can't hold, an index out of range, a coordinate that is not finite;
/// naming the line of an ascii file and the byte of a binary one.
pub(super) fn read(bytes: &[u8], _: &Context) -> Result<Scene> {
    let header = header::read(bytes)?;
    let body = Body::new(bytes, header.body, header.encoding);
    let vertices = one(&header.elements, b"vertex")?.map_or(0, |e| e.count);
    one(&header.elements, b"face")?;
    let mut reader = Reader { body, vertices, part: Part::default(), notes: Notes::default() };
    for element in &header.elements {
        reader.element(element)?;
    }
    reader.finish()
}

/// The element of that name, which may be there once.
fn one<'e, 'a>(elements: &'e [Element<'a>], name: &[u8]) -> Result<Option<&'e Element<'a>>> {
    let mut found = elements.iter().filter(|e| e.name == name);
    match (found.next(), found.next()) {
        (_, Some(_)) => Err(Error::at("header", format!("element '{}' is there twice", String::from_utf8_lossy(name)))),
        (element, None) => Ok(element),
    }
}

struct Reader<'a> {
    body: Body<'a>,
    /// How many vertices the header claims; they may come after the faces.
    vertices: u64,
    part: Part,
    notes: Notes,
}

impl Reader<'_> {
    fn element(&mut self, element: &Element) -> Result<()> {
        let count = self.body.can_hold(element)?;
        let list = element.list(&[b"vertex_indices", b"vertex_index"]);
        match (element.name, list) {
            (b"vertex", _) => self.vertices(element, count),
            (b"face", Some(list)) => self.faces(element, count, list),
            _ => self.skipped(element, count),
        }
    }

    fn vertices(&mut self, element: &Element, count: usize) -> Result<()> {
        let missing = |axis: &str| Error::at("header", format!("element 'vertex' has no property '{axis}'"));
        let axis = |name: &str| element.number(name.as_bytes()).ok_or_else(|| missing(name));
        let axes = [axis("x")?, axis("y")?, axis("z")?];
        self.notes.add("vertex properties other than x, y, z", element.properties.len() - 3);
        grow::reserve(&mut self.part.positions, count)?;
        for _ in 0..count {
            let mut position = [0.0; 3];
            for (number, property) in element.properties.iter().enumerate() {
                match axes.iter().position(|&a| a == number) {
                    Some(axis) => position[axis] = self.body.coordinate(property.kind)?,
                    None => self.body.skip(property)?,
                }
            }
            self.part.positions.push(position);
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element, count: usize, list: usize) -> Result<()> {
        self.notes.add("face properties other than the vertices", element.properties.len() - 1);
        grow::reserve(&mut self.part.triangles, count)?;
        for _ in 0..count {
            for (number, property) in element.properties.iter().enumerate() {
                match property.list {
                    Some(length) if number == list => self.polygon(length, property.kind)?,
                    _ => self.body.skip(property)?,
                }
            }
        }
        Ok(())
    }

    fn polygon(&mut self, length: header::Scalar, item: header::Scalar) -> Result<()> {
        let mut fan = Fan::default();
        for _ in 0..self.body.length(length, item)? {
            let index = self.body.index(item, self.vertices)?;
            if let Some(triangle) = fan.corner(index) {
                grow::push(&mut self.part.triangles, triangle)?;
            }
        }
        self.notes.add("polygons of fewer than 3 corners", (fan.corners < 3).into());
        self.notes.add("polygons split into triangles", (fan.corners > 3).into());
        Ok(())
    }

    fn skipped(&mut self, element: &Element, count: usize) -> Result<()> {
        let what = match element.name {
            b"face" => "faces without a list of vertices",
            b"edge" => "edges",
            b"tristrips" => "lists of triangle strips",
            b"material" => "materials",
            _ => "elements of other kinds",
        };
        self.notes.add(what, count);
        // Without properties there is nothing to go past, however many elements are claimed.
        let count = if element.properties.is_empty() { 0 } else { count };
        (0..count).try_for_each(|_| element.properties.iter().try_for_each(|p| self.body.skip(p)))
    }

    fn finish(mut self) -> Result<Scene> {
        let left = if self.body.is_at_end() { 0 } else { self.body.left() };
        self.notes.add("bytes after the last element", left);
        if self.part.triangles.is_empty() {
            self.notes.add("vertices without a face", self.part.positions.len());
        }
        assemble(vec![self.part], [0.0, 0.0, 1.0], self.notes.finish())
    }
}

#[cfg(test)]
mod tests;
