//! The header: what a file claims to be, and where its parts lie.

use std::ops::Range;

use xxhash_rust::xxh3::xxh3_64;

use super::{ALIGN, CHECKED, HEADER, MAGIC, ROW, VERSION, fail};
use crate::error::{Error, Result};
use crate::parts::{Listed, Part, Written};

/// A header that fits its file.
pub(super) struct Header {
    pub(super) layout: u32,
    /// The checksum of the mesh.
    pub(super) mesh: u64,
    /// Where the description lies.
    pub(super) description: Range<usize>,
    pub(super) parts: Vec<Listed>,
}

impl Header {
    /// For a file of these parts.
    pub(super) fn new(layout: u32, mesh: u64, description: usize, parts: &[Written<'_>]) -> Self {
        let start = HEADER + ROW * parts.len();
        let mut end = start + description;
        let listed = parts.iter().map(|part| {
            let place = end.next_multiple_of(ALIGN);
            end = place + part.bytes.len();
            Listed { part: part.part, stride: part.stride, range: place..end }
        });
        let parts = listed.collect();
        Self { layout, mesh, description: start..start + description, parts }
    }

    /// Length of the file.
    pub(super) fn length(&self) -> usize {
        self.parts.last().map_or(self.description.end, |last| last.range.end)
    }

    /// Everything from the checksummed part on up to the description.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.description.start - CHECKED);
        let mut words = |words: &[u64]| words.iter().for_each(|word| out.extend(word.to_le_bytes()));
        words(&[self.length() as u64, self.mesh, self.description.len() as u64, self.parts.len() as u64, 0]);
        for Listed { part, stride, range } in &self.parts {
            let number = *part as u64 | (*stride as u64) << 32;
            words(&[number, range.start as u64, (range.len() / stride) as u64, 0]);
        }
        out
    }

    /// Checks all of a file but what its description and its parts say.
    pub(super) fn read(data: &[u8]) -> Result<Self> {
        if data.len() < HEADER {
            if !data.starts_with(&MAGIC[..data.len().min(MAGIC.len())]) {
                return fail(0, "this is not a .rdh file");
            }
            return fail(data.len(), format!("the file ends within its header of {HEADER} bytes"));
        }
        if &data[..8] != MAGIC {
            return fail(0, "this is not a .rdh file");
        }
        if u32_at(data, 8) != VERSION {
            return fail(8, format!("version {}; this program reads version {VERSION}", u32_at(data, 8)));
        }
        let length = u64_at(data, 24);
        if length != data.len() as u64 {
            let at = data.len().min(usize::try_from(length).unwrap_or(usize::MAX));
            return fail(at, format!("{} bytes, but the file should have {length}", data.len()));
        }
        if u64_at(data, 16) != xxh3_64(&data[CHECKED..]) {
            return fail(16, "the checksum does not match: the file was altered or damaged");
        }
        expect_zeros(data, 56..HEADER)?;
        let description = description(data)?;
        let parts = parts(data, &description)?;
        Ok(Self { layout: u32_at(data, 12), mesh: u64_at(data, 32), description, parts })
    }
}

/// Where the description lies, behind the table of parts.
fn description(data: &[u8]) -> Result<Range<usize>> {
    let [length, parts] = [40, 48].map(|at| u64_at(data, at));
    let range = || {
        let start = usize::try_from(parts).ok()?.checked_mul(ROW)?.checked_add(HEADER)?;
        let end = start.checked_add(usize::try_from(length).ok()?)?;
        (end <= data.len()).then_some(start..end)
    };
    let reason = || format!("{parts} parts and a description of {length} bytes don't fit into {} bytes", data.len());
    range().ok_or_else(|| Error::Format { offset: 40, reason: reason() })
}

/// The table of parts: known ones in order, which fill the rest of the file.
fn parts(data: &[u8], description: &Range<usize>) -> Result<Vec<Listed>> {
    let mut parts: Vec<Listed> = Vec::new();
    let mut end = description.end;
    for row in (HEADER..description.start).step_by(ROW) {
        let [number, stride] = [0, 4].map(|at| u32_at(data, row + at));
        let Some(part) = Part::numbered(number).filter(|&part| parts.last().is_none_or(|last| last.part < part)) else {
            return fail(row, format!("part {number} is not known, or does not come here"));
        };
        let place = end.next_multiple_of(ALIGN);
        if u64_at(data, row + 8) != place as u64 {
            return fail(row + 8, format!("{} at byte {} instead of {place}", part.name(), u64_at(data, row + 8)));
        }
        let stride = stride as usize;
        let count = u64_at(data, row + 16);
        let bytes = usize::try_from(count).ok().filter(|_| stride > 0).and_then(|count| count.checked_mul(stride));
        let Some(range) =
            bytes.and_then(|bytes| Some(place..place.checked_add(bytes)?)).filter(|r| r.end <= data.len())
        else {
            return fail(row + 16, format!("{count} {} of {stride} bytes don't fit into the file", part.name()));
        };
        expect_zeros(data, row + 24..row + ROW)?;
        expect_zeros(data, end..place)?;
        end = range.end;
        parts.push(Listed { part, stride, range });
    }
    if end == data.len() { Ok(parts) } else { fail(end, "there is more than the parts that are listed") }
}

fn expect_zeros(data: &[u8], range: Range<usize>) -> Result<()> {
    let start = range.start;
    match data.get(range).map(|bytes| bytes.iter().position(|&b| b != 0)) {
        Some(None) => Ok(()),
        Some(Some(i)) => fail(start + i, "the padding is not zero"),
        None => fail(data.len(), "the file ends too soon"),
    }
}

fn u32_at(data: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|i| data[at + i]))
}

fn u64_at(data: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(std::array::from_fn(|i| data[at + i]))
}
