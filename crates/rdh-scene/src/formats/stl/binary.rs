//! Binary STL: 80 bytes of anything, a count, and 50 bytes a triangle.

use super::weld::Weld;
use crate::error::{Error, Result};
use crate::formats::assemble::Part;
use crate::formats::notes::Notes;
use crate::formats::text::in_range;

/// Bytes before the count.
pub(super) const HEADER: usize = 80;
const FACET: usize = 50;

/// Whether the file is exactly as long as its count says.
pub(super) fn size_fits(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| count.checked_mul(FACET) == Some(bytes.len() - HEADER - 4))
}

/// Reads the one part of a binary file.
///
/// # Errors
/// A count that doesn't fit the file's size, or a coordinate that isn't finite.
pub(super) fn read(bytes: &[u8], notes: &mut Notes) -> Result<Vec<Part>> {
    let Some(count) = count(bytes) else {
        let reason = format!("a binary STL has at least {} bytes, and this file only {}", HEADER + 4, bytes.len());
        return Err(Error::whole(reason));
    };
    let (facets, rest) = bytes[HEADER + 4..].as_chunks::<FACET>();
    if count != facets.len() {
        let reason = format!("the header's count is {count}, but there are bytes for {} triangles", facets.len());
        return Err(Error::at(format!("byte {HEADER}"), reason));
    }
    let mut weld = Weld::default();
    for (number, facet) in facets.iter().enumerate() {
        weld.triangle(corners(facet).map_err(|reason| {
            let byte = HEADER + 4 + number * FACET;
            Error::at(format!("byte {byte} (triangle {number})"), reason)
        })?)?;
    }
    notes.add("facet normals", count);
    notes.add("facet attributes", facets.iter().filter(|f| f[48..] != [0, 0]).count());
    notes.add("bytes after the last triangle", rest.len());
    Ok(vec![weld.finish()])
}

fn count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

/// The corners of a facet: after the normal, 9 floats.
fn corners(facet: &[u8; FACET]) -> Result<[[f64; 3]; 3], String> {
    let (floats, _) = facet[12..48].as_chunks::<4>();
    let mut corners = [[0.0; 3]; 3];
    for (x, float) in corners.as_flattened_mut().iter_mut().zip(floats) {
        *x = in_range(f64::from(f32::from_le_bytes(*float)))?;
    }
    Ok(corners)
}
