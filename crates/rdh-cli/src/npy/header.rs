//! What an array file says about its array.

use std::io::{self, Read, Write};

use anyhow::{Context as _, Result, bail, ensure};

use super::dict::Dict;

const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// NumPy's own limit.
const LONGEST: usize = 10_000;

/// Numbers that rays may be given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
    F32,
    F64,
}

/// A header of an array of numbers, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    pub number: Number,
    pub big_endian: bool,
    pub shape: Vec<u64>,
    /// Bytes before the numbers.
    pub length: u64,
}

impl Number {
    /// Bytes of one.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Header {
    /// Reads a header and no more.
    pub(crate) fn read(input: &mut impl Read) -> Result<Self> {
        let mut start = [0; 8];
        input.read_exact(&mut start).ok().filter(|()| start.starts_with(MAGIC)).context("this is no .npy file")?;
        let (length, before) = match start[6] {
            1 => (usize::from(u16::from_le_bytes(bytes(input)?)), 10),
            2 | 3 => (u32::from_le_bytes(bytes(input)?) as usize, 12),
            version => bail!("version {version} of .npy files is not known"),
        };
        ensure!(length <= LONGEST, "the header has {length} bytes; {LONGEST} are possible");
        let mut text = vec![0; length];
        input.read_exact(&mut text).context("the file ends within its header")?;
        let dict = Dict::parse(std::str::from_utf8(&text).context("the header is not UTF-8")?)?;
        ensure!(
            !dict.fortran_order || dict.shape.len() < 2,
            "the array lies column by column; save numpy.ascontiguousarray of it"
        );
        let (number, big_endian) = number(&dict.descr)?;
        Ok(Self { number, big_endian, shape: dict.shape, length: (before + length) as u64 })
    }
}

fn bytes<const N: usize>(input: &mut impl Read) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes).context("the file ends within its header")?;
    Ok(bytes)
}

fn number(descr: &str) -> Result<(Number, bool)> {
    Ok(match descr {
        "<f4" => (Number::F32, false),
        "<f8" => (Number::F64, false),
        ">f4" => (Number::F32, true),
        ">f8" => (Number::F64, true),
        other => bail!("elements of type '{other}'; rays are f4 or f8"),
    })
}

/// Writes the header of an array whose elements are `descr`, a Python literal.
pub(crate) fn write(out: &mut impl Write, descr: &str, shape: &[u64]) -> io::Result<()> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let mut text = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': ({}), }}", sides.trim_end());
    // The numbers begin at a multiple of 64.
    let blanks = 64 - (MAGIC.len() + 4 + text.len() + 1) % 64;
    text.push_str(&" ".repeat(blanks));
    text.push('\n');
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(text.len() as u16).to_le_bytes())?;
    out.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(shape: &[u64]) -> Vec<u8> {
        let mut out = Vec::new();
        write(&mut out, "'<f4'", shape).unwrap();
        out
    }

    #[test]
    fn what_is_written_is_read() {
        for shape in [&[][..], &[5], &[5, 8], &[1 << 40, 3, 8]] {
            let bytes = written(shape);
            assert_eq!(bytes.len() % 64, 0);
            let header = Header::read(&mut &bytes[..]).unwrap();
            let expected =
                Header { number: Number::F32, big_endian: false, shape: shape.to_vec(), length: bytes.len() as u64 };
            assert_eq!(header, expected);
        }
    }

    #[test]
    fn cut_off_or_foreign_headers_are_errors() {
        let bytes = written(&[5, 8]);
        for len in 0..bytes.len() {
            assert!(Header::read(&mut &bytes[..len]).is_err());
        }
        let long = [&MAGIC[..], &[2, 0], &u32::MAX.to_le_bytes()].concat();
        assert!(Header::read(&mut &long[..]).unwrap_err().to_string().contains("4294967295"));
        for (from, to) in [("'<f4'", "'<i4'"), ("False", "True "), ("5, 8", "-, 8")] {
            let other = String::from_utf8_lossy(&bytes[10..]).replace(from, to);
            let other = [&bytes[..10], other.as_bytes()].concat();
            assert!(Header::read(&mut &other[..]).is_err(), "{to}");
        }
    }
}
