//! Ascii STL: `solid`, facets of three vertices, `endsolid`; as often as you like.

use super::weld::Weld;
use crate::error::Result;
use crate::formats::assemble::Part;
use crate::formats::grow;
use crate::formats::notes::Notes;
use crate::formats::text::{Text, coordinate, number, shown};

/// Reads the solids of an ascii file. Solids without a facet are left out, with a note.
///
/// # Errors
/// Anything out of place, naming the line.
pub(super) fn read(bytes: &[u8], notes: &mut Notes) -> Result<Vec<Part>> {
    let mut reader = Reader { text: Text::new(bytes) };
    let mut parts = Vec::new();
    while !reader.text.is_at_end() {
        let part = reader.solid()?;
        notes.add("facet normals", part.triangles.len());
        if part.triangles.is_empty() {
            notes.add("solids without a facet", 1);
        } else {
            grow::push(&mut parts, part)?;
        }
    }
    Ok(parts)
}

struct Reader<'a> {
    text: Text<'a>,
}

impl<'a> Reader<'a> {
    fn solid(&mut self) -> Result<Part> {
        self.expect("solid")?;
        let name = String::from_utf8_lossy(self.text.rest_of_line().trim_ascii()).into_owned();
        let mut weld = Weld::new(name);
        loop {
            let word = self.word("'facet' or 'endsolid'")?;
            if word.eq_ignore_ascii_case(b"endsolid") {
                // The name again, or nothing.
                self.text.rest_of_line();
                return Ok(weld.finish());
            }
            if !word.eq_ignore_ascii_case(b"facet") {
                return Err(self.unexpected(word, &format!("'facet' or 'endsolid' after {} facets", weld.len())));
            }
            weld.triangle(self.facet()?)?;
        }
    }

    /// `normal x y z outer loop`, three vertices, `endloop endfacet`.
    fn facet(&mut self) -> Result<[[f64; 3]; 3]> {
        self.expect("normal")?;
        for _ in 0..3 {
            // Some programs write NaN here for flat facets; the normal isn't used.
            let word = self.word("a normal")?;
            number(word).map_err(|reason| self.text.error(self.text.at - word.len(), reason))?;
        }
        self.expect("outer")?;
        self.expect("loop")?;
        let mut corners = [[0.0; 3]; 3];
        for corner in &mut corners {
            self.expect("vertex")?;
            for x in corner {
                let word = self.word("a coordinate")?;
                *x = coordinate(word).map_err(|reason| self.text.error(self.text.at - word.len(), reason))?;
            }
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        Ok(corners)
    }

    fn expect(&mut self, keyword: &str) -> Result<()> {
        let expected = format!("'{keyword}'");
        let word = self.word(&expected)?;
        if word.eq_ignore_ascii_case(keyword.as_bytes()) { Ok(()) } else { Err(self.unexpected(word, &expected)) }
    }

    fn word(&mut self, expected: &str) -> Result<&'a [u8]> {
        let word = self.text.word();
        word.ok_or_else(|| self.text.error(self.text.at, format!("the file ends where {expected} should be")))
    }

    fn unexpected(&self, word: &[u8], expected: &str) -> crate::error::Error {
        self.text.error(self.text.at - word.len(), format!("expected {expected}, found '{}'", shown(word)))
    }
}
