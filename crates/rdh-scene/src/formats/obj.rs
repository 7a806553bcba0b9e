//! Wavefront OBJ: its vertices and polygons; everything else is dropped with a note.
//!
//! An own reader and not the `tobj` crate: its errors don't say the line, and one line of two corners makes it refuse
//! a whole file. The file becomes one geometry, its vertices shared by all groups, in the file's order; polygons
//! become fans. OBJ has no up direction: +y by custom.

use super::assemble::{Part, assemble};
use super::notes::Notes;
use super::text::{Text, coordinate, shown};
use super::{Context, grow};
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Reads an OBJ file; it refers to no other.
///
/// # Errors
/// A malformed vertex or face, a vertex index out of range, or neither vertices nor faces; naming the line.
pub(super) fn read(bytes: &[u8], _: &Context) -> Result<Scene> {
    let mut reader = Reader { text: Text::new(bytes), part: Part::default(), notes: Notes::default(), furthest: None };
    reader.statements()?;
    reader.finish()
}

struct Reader<'a> {
    text: Text<'a>,
    part: Part,
    notes: Notes,
    /// The largest vertex index of a face so far and where it stands: faces may come before their vertices.
    furthest: Option<(u32, usize)>,
}

impl Reader<'_> {
    fn statements(&mut self) -> Result<()> {
        while let Some(keyword) = self.text.word() {
            match keyword {
                b"v" => self.vertex()?,
                b"f" | b"fo" => self.face()?,
                _ if keyword[0] == b'#' => {
                    self.text.rest_of_line();
                    continue;
                }
                _ => self.notes.add(dropped(keyword), 1),
            }
            self.text.skip_line();
        }
        Ok(())
    }

    /// `v x y z`; a weight or a colour may follow, which are dropped.
    fn vertex(&mut self) -> Result<()> {
        let start = self.text.at;
        let mut position = [0.0; 3];
        for x in &mut position {
            let Some(word) = self.text.word_in_line() else {
                return Err(self.text.error(start, "a vertex needs three coordinates"));
            };
            *x = coordinate(word).map_err(|reason| self.text.error(start, reason))?;
        }
        let more = self.text.word_in_line().is_some_and(|w| w[0] != b'#');
        self.notes.add("vertex weights and colours", more.into());
        grow::push(&mut self.part.positions, position)
    }

    /// `f 1 2 3`, `f 1/1 2/2 3/3`, `f -3//1 -2//1 -1//1`, and so on: a polygon.
    fn face(&mut self) -> Result<()> {
        let mut fan = Fan::default();
        while let Some(word) = self.text.word_in_line().filter(|w| w[0] != b'#') {
            let at = self.text.at - word.len();
            let index = self.vertex_index(word).map_err(|reason| self.text.error(at, reason))?;
            if self.furthest.is_none_or(|(furthest, _)| index > furthest) {
                self.furthest = Some((index, at));
            }
            if let Some(triangle) = fan.corner(index) {
                grow::push(&mut self.part.triangles, triangle)?;
            }
        }
        self.notes.add("polygons of fewer than 3 corners", (fan.corners < 3).into());
        self.notes.add("polygons split into triangles", (fan.corners > 3).into());
        Ok(())
    }

    /// The vertex of a face's corner, counted from 0. What follows a slash is the texture's and the normal's.
    fn vertex_index(&self, word: &[u8]) -> Result<u32, String> {
        let digits = word.split(|&b| b == b'/').next().unwrap_or_default();
        let index: Option<i64> = std::str::from_utf8(digits).ok().and_then(|d| d.parse().ok());
        let read = self.part.positions.len() as i64;
        match index {
            None => Err(format!("'{}' is not a vertex index", shown(word))),
            Some(0) => Err("vertex index 0: indices count from 1".to_owned()),
            Some(back @ ..0) => u32::try_from(read.saturating_add(back))
                .map_err(|_| format!("vertex index {back} is out of range ({read} vertices so far)")),
            Some(index) => {
                u32::try_from(index - 1).map_err(|_| format!("vertex index {index} is larger than can be numbered"))
            }
        }
    }

    fn finish(mut self) -> Result<Scene> {
        let vertices = self.part.positions.len();
        match self.furthest {
            Some((index, at)) if index as usize >= vertices => {
                let reason = format!("vertex index {} is out of range (the file has {vertices})", u64::from(index) + 1);
                return Err(self.text.error(at, reason));
            }
            None if vertices == 0 => return Err(Error::whole("no line with a vertex or face: is it an OBJ file?")),
            _ => {}
        }
        if self.part.triangles.is_empty() {
            self.notes.add("vertices without a face", vertices);
        }
        assemble(vec![self.part], [0.0, 1.0, 0.0], self.notes.finish())
    }
}

/// Splits a polygon into triangles round its first corner.
#[derive(Debug, Default)]
pub(super) struct Fan {
    first: u32,
    last: u32,
    /// How many corners there were.
    pub corners: usize,
}

impl Fan {
    /// Takes the next corner; from the third on, each makes a triangle.
    pub(super) fn corner(&mut self, index: u32) -> Option<[u32; 3]> {
        let triangle = [self.first, self.last, index];
        if self.corners == 0 {
            self.first = index;
        }
        self.last = index;
        self.corners += 1;
        (self.corners > 2).then_some(triangle)
    }
}

/// What a statement that is not read is about.
fn dropped(keyword: &[u8]) -> &'static str {
    match keyword {
        b"vt" => "texture coordinates",
        b"vn" => "vertex normals",
        b"mtllib" => "material libraries",
        b"usemtl" => "uses of materials",
        b"o" | b"g" => "names of objects and groups",
        b"s" => "smoothing groups",
        b"p" => "points",
        b"l" => "polylines",
        b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim" | b"hole"
        | b"scrv" | b"sp" | b"end" | b"con" | b"mg" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res" => {
            "statements about curves and surfaces"
        }
        b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"maplib" | b"usemap" | b"shadow_obj" | b"trace_obj"
        | b"ctech" | b"stech" => "statements about display",
        b"call" | b"csh" => "calls of other files and programs",
        _ => "unknown statements",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(text: &str) -> Scene {
        read(text.as_bytes(), &Context::default()).unwrap()
    }

    fn error(text: &str) -> String {
        read(text.as_bytes(), &Context::default()).unwrap_err().to_string()
    }

    #[test]
    fn reads_every_way_to_name_a_corner() {
        let scene = part("v 0 0 0 1.0\nv 1 0 0\nv 0 1 0\nf 1 2/7 3//9 # end\nf -3/1/1 \\\n -2 -1\nvt 0 0\n");
        assert_eq!(scene.geometries[0].triangles, [[0, 1, 2], [0, 1, 2]]);
        let notes: Vec<_> = scene.notes.iter().map(|n| (n.what.as_str(), n.count)).collect();
        assert_eq!(notes, [("vertex weights and colours", 1), ("texture coordinates", 1)]);
    }

    #[test]
    fn splits_polygons_into_fans_and_drops_lines() {
        let scene = part("f 1 2 3 4\r\nf 1 2\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\n");
        assert_eq!(scene.geometries[0].triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(scene.notes.len(), 2);
    }

    #[test]
    fn keeps_far_coordinates_fine() {
        let scene = part("v 84616.468 447422.999 0\nv 84617.468 447422.999 0\nv 84616.468 447423.999 0\nf 1 2 3");
        let x = f64::from(scene.geometries[0].positions[0][0]) + scene.origin[0];
        assert!((x - 84616.468).abs() < 1e-6, "{x}");
    }

    #[test]
    fn errors_name_the_line() {
        let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
        assert_eq!(error(&format!("{square}f 1 2 9")), "line 4: vertex index 9 is out of range (the file has 3)");
        assert_eq!(error(&format!("{square}\nf 0 1 2")), "line 5: vertex index 0: indices count from 1");
        assert_eq!(error(&format!("{square}f -4 1 2")), "line 4: vertex index -4 is out of range (3 vertices so far)");
        assert_eq!(error(&format!("{square}f 1 2 x")), "line 4: 'x' is not a vertex index");
        assert_eq!(error("v 0 0\nv 1 0 0"), "line 1: a vertex needs three coordinates");
        assert_eq!(error("v 0 nan 0"), "line 1: coordinate NaN is not a finite number");
        assert_eq!(error("v 0 1e39 0"), "line 1: coordinate 1e39 is beyond the range of 32-bit floats");
    }
}
