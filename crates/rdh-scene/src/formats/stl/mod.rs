//! STL: ascii with one or more solids, and binary.
//!
//! Each solid becomes a geometry. STL has no vertex indices: corners with the same bits become one vertex. The facets'
//! normals are dropped; they follow from the corners. STL has no up direction: +z by custom.
//!
//! An own reader: the `stl_io` crate reads a file silently short if its header's count is too small, and lets
//! coordinates pass that aren't numbers.

mod ascii;
mod binary;
mod weld;

use super::Context;
use super::assemble::assemble;
use super::notes::Notes;
use crate::error::Result;
use crate::scene::Scene;

/// Reads an STL file; it refers to no other.
///
/// # Errors
/// A malformed facet, a count that doesn't fit the file's size, a coordinate that is not finite; naming the line of an
/// ascii file and the byte of a binary one.
pub(super) fn read(bytes: &[u8], _: &Context) -> Result<Scene> {
    let mut notes = Notes::default();
    let parts = if is_ascii(bytes) { ascii::read(bytes, &mut notes)? } else { binary::read(bytes, &mut notes)? };
    assemble(parts, [0.0, 0.0, 1.0], notes.finish())
}

/// Both kinds may start with "solid". A binary file's size fits its count; otherwise an ascii file has no zero byte
/// where a binary one has its header.
fn is_ascii(bytes: &[u8]) -> bool {
    let starts_solid = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    starts_solid && !binary::size_fits(bytes) && !bytes.iter().take(binary::HEADER).any(|&b| b == 0)
}

#[cfg(test)]
mod tests;
