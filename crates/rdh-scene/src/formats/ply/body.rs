//! The numbers of a PLY file's body, one after the other.

use super::header::{Element, Encoding, Property, Scalar};
use crate::error::{Error, Result};
use crate::formats::text::{Text, in_range, line_of, number};

/// Walks through the body.
pub(super) struct Body<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    text: Text<'a>,
    /// Where the last number starts.
    last: usize,
}

impl<'a> Body<'a> {
    pub(super) fn new(bytes: &'a [u8], start: usize, encoding: Encoding) -> Self {
        let mut text = Text::new(bytes);
        text.at = start;
        Self { encoding, bytes, text, last: start }
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.text.at
    }

    /// Whether nothing but white space (in ascii) is left.
    pub(super) fn is_at_end(&mut self) -> bool {
        match self.encoding {
            Encoding::Ascii => self.text.is_at_end(),
            _ => self.left() == 0,
        }
    }

    /// Checks that so many elements can be there at all, before any memory is taken for them.
    pub(super) fn can_hold(&self, element: &Element) -> Result<usize> {
        let needed = element.count.checked_mul(element.least_bytes(self.encoding) as u64);
        // The last number of an ascii body needs no space behind it.
        match usize::try_from(element.count) {
            Ok(count) if needed.is_some_and(|n| n <= self.left() as u64 + 1) => Ok(count),
            _ => {
                let (name, count, left) = (String::from_utf8_lossy(element.name), element.count, self.left());
                let reason = format!("the header claims {count} elements '{name}', but only {left} bytes are left");
                Err(self.error(self.text.at, reason))
            }
        }
    }

    /// The next number. All of PLY's types fit into f64 exactly.
    pub(super) fn scalar(&mut self, kind: Scalar) -> Result<f64> {
        match self.encoding {
            Encoding::Ascii => {
                let word = self.text.word().ok_or_else(|| self.error(self.bytes.len(), "the file ends too soon"))?;
                self.last = self.text.at - word.len();
                number(word).map_err(|reason| self.error(self.last, reason))
            }
            Encoding::LittleEndian => self.binary(kind, false),
            Encoding::BigEndian => self.binary(kind, true),
        }
    }

    /// The next number, as a coordinate.
    pub(super) fn coordinate(&mut self, kind: Scalar) -> Result<f64> {
        let x = self.scalar(kind)?;
        in_range(x).map_err(|reason| self.error_there(reason))
    }

    /// The next number, as a vertex index.
    pub(super) fn index(&mut self, kind: Scalar, vertices: u64) -> Result<u32> {
        let x = self.scalar(kind)?;
        match whole(x) {
            Some(index) if u64::from(index) < vertices => Ok(index),
            _ => Err(self.error_there(format!("vertex index {x} is out of range (the file has {vertices})"))),
        }
    }

    /// The length of a list, which the rest of the file can hold.
    pub(super) fn length(&mut self, kind: Scalar, item: Scalar) -> Result<usize> {
        let x = self.scalar(kind)?;
        let least = if self.encoding == Encoding::Ascii { 2 } else { item.bytes() };
        match whole(x) {
            Some(length) if u64::from(length) * least as u64 <= self.left() as u64 + 1 => Ok(length as usize),
            Some(length) => {
                Err(self.error_there(format!("a list of {length}, but only {} bytes are left", self.left())))
            }
            None => Err(self.error_there(format!("a list can't have length {x}"))),
        }
    }

    /// Goes past one property.
    pub(super) fn skip(&mut self, property: &Property) -> Result<()> {
        let Some(length) = property.list else { return self.scalar(property.kind).map(drop) };
        (0..self.length(length, property.kind)?).try_for_each(|_| self.scalar(property.kind).map(drop))
    }

    /// An error at the last number.
    fn error_there(&self, reason: impl Into<String>) -> Error {
        self.error(self.last, reason)
    }

    fn error(&self, at: usize, reason: impl Into<String>) -> Error {
        match self.encoding {
            Encoding::Ascii => Error::at(line_of(self.bytes, at), reason),
            _ => Error::at(format!("byte {at}"), reason),
        }
    }

    fn binary(&mut self, kind: Scalar, big_endian: bool) -> Result<f64> {
        let from = self.text.at;
        let Some(bytes) = self.bytes.get(from..from + kind.bytes()) else {
            return Err(self.error(from, "the file ends too soon"));
        };
        self.last = from;
        self.text.at += bytes.len();
        let mut eight = [0; 8];
        eight[..bytes.len()].copy_from_slice(bytes);
        if big_endian {
            eight[..bytes.len()].reverse();
        }
        let [a, b, c, d, ..] = eight;
        Ok(match kind {
            Scalar::I8 => f64::from(a as i8),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(eight),
        })
    }
}

/// A number that is a whole one and not too large for an index.
fn whole(x: f64) -> Option<u32> {
    (x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0).then_some(x as u32)
}
