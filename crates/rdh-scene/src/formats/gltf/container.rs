//! The JSON of a document and the buffer that comes with it: one file of text, or the chunks of a GLB.

use super::budget::Budget;
use super::schema::Root;
use crate::error::{Error, Result};

/// What an object of the JSON takes in memory at most, with what is later made of it: a node with its transform and
/// its instance.
const BYTES_AN_OBJECT: u64 = 400;

/// Splits a GLB into its JSON and its binary chunk; anything else is all JSON.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    let Some(after_magic) = bytes.strip_prefix(b"glTF") else { return Ok((bytes, None)) };
    let (version, length) = (word(after_magic, 0), word(after_magic, 4));
    let (Some(version), Some(length)) = (version, length) else {
        return Err(Error::whole(format!("a GLB header has 12 bytes, and this file only {}", bytes.len())));
    };
    if version != 2 {
        return Err(Error::at("byte 4", format!("GLB version {version}; only version 2 can be read")));
    }
    let Some(body) = bytes.get(12..length) else {
        let reason = format!("the header's length is {length}, but the file has {} bytes", bytes.len());
        return Err(Error::at("byte 8", reason));
    };
    let (json, rest) = chunk(body, 12, *b"JSON")?;
    let json = json.ok_or_else(|| Error::at("byte 16", "the first chunk of a GLB must be its JSON"))?;
    let binary = if rest.is_empty() { None } else { chunk(rest, length - rest.len(), *b"BIN\0")?.0 };
    Ok((json, binary))
}

/// Reads the JSON.
///
/// # Errors
/// Malformed JSON, by line and column; another version than 2; an extension that is needed and not known.
pub(super) fn parse(json: &[u8], budget: &Budget) -> Result<Root> {
    let objects = json.iter().filter(|&&b| b == b'{').count();
    budget.spend(objects as u64, BYTES_AN_OBJECT, "JSON")?;
    let root: Root = serde_json::from_slice(json).map_err(|e| Error::at("JSON", e.to_string()))?;
    if !root.asset.version.starts_with("2.") {
        let reason = format!("glTF version {}; only version 2 can be read", root.asset.version);
        return Err(Error::at("asset", reason));
    }
    match root.extensions_required.0.iter().find(|name| !is_harmless(name)) {
        Some(name) => Err(Error::at("extensionsRequired", format!("extension {name} is not supported"))),
        None => Ok(root),
    }
}

/// Whether geometry can be read without knowing an extension. Quantised positions need nothing but what the accessors
/// say.
fn is_harmless(extension: &str) -> bool {
    const APPEARANCE: [&str; 6] =
        ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp"];
    extension == "KHR_mesh_quantization" || APPEARANCE.iter().any(|prefix| extension.starts_with(prefix))
}

/// A chunk's data and what follows it; no data if it is of another kind.
type Chunk<'a> = (Option<&'a [u8]>, &'a [u8]);

fn chunk(bytes: &[u8], at: usize, kind: [u8; 4]) -> Result<Chunk<'_>> {
    let cut = |reason: String| Error::at(format!("byte {at}"), reason);
    let (Some(length), Some(found)) = (word(bytes, 0), bytes.get(4..8)) else {
        return Err(cut("a chunk's header is cut short".to_owned()));
    };
    let data = &bytes[8..];
    match data.split_at_checked(length) {
        Some((data, rest)) => Ok(((found == kind).then_some(data), rest)),
        None => Err(cut(format!("a chunk's length is {length}, but only {} bytes are left", data.len()))),
    }
}

/// A little-endian number of four bytes.
fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*word)).ok()
}
