//! The header of a PLY file: which elements follow, with which properties.

use crate::error::{Error, Result};
use crate::formats::grow;
use crate::formats::text::{Text, shown};

/// How the body is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Its size in a binary body.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The type of a name in the header.
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
}

/// A property of each element of a kind.
#[derive(Debug)]
pub(super) struct Property<'a> {
    pub name: &'a [u8],
    /// For a list, the type of its length.
    pub list: Option<Scalar>,
    /// The type of the value, or of a list's items.
    pub kind: Scalar,
}

/// A kind of element, and how many there are.
#[derive(Debug)]
pub(super) struct Element<'a> {
    pub name: &'a [u8],
    pub count: u64,
    pub properties: Vec<Property<'a>>,
}

impl Element<'_> {
    /// The fewest bytes that one such element can take: lists are empty, numbers in ascii have one digit and a space.
    pub(super) fn least_bytes(&self, encoding: Encoding) -> usize {
        let least = |p: &Property| match encoding {
            Encoding::Ascii => 2,
            _ => p.list.unwrap_or(p.kind).bytes(),
        };
        self.properties.iter().map(least).sum()
    }

    /// Where a plain number of that name stands among the properties.
    pub(super) fn number(&self, name: &[u8]) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name && p.list.is_none())
    }

    /// Where a list of one of these names stands among the properties.
    pub(super) fn list(&self, names: &[&[u8]]) -> Option<usize> {
        self.properties.iter().position(|p| names.contains(&p.name) && p.list.is_some())
    }
}

/// What the header says.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub encoding: Encoding,
    pub elements: Vec<Element<'a>>,
    /// Where the body starts.
    pub body: usize,
}

/// Reads the header.
///
/// # Errors
/// Any line that is not as PLY 1.0 has it, by number; or a header without end.
pub(super) fn read(bytes: &[u8]) -> Result<Header<'_>> {
    let mut text = Text::new(bytes);
    if text.rest_of_line().trim_ascii_end() != b"ply" {
        return Err(Error::at("line 1", "a PLY file starts with 'ply'"));
    }
    let mut encoding = None;
    let mut elements = Vec::new();
    loop {
        let Some(keyword) = text.word() else {
            return Err(text.error(bytes.len(), "the header has no end ('end_header' is missing)"));
        };
        let at = text.at - keyword.len();
        match keyword {
            b"comment" | b"obj_info" => {
                text.rest_of_line();
            }
            b"end_header" => break,
            _ => {
                let line = Line { at, words: words(&mut text) };
                line.read(keyword, &mut encoding, &mut elements).map_err(|reason| text.error(at, reason))??;
            }
        }
    }
    let encoding = encoding.ok_or_else(|| text.error(text.at, "the header has no 'format' line"))?;
    Ok(Header { encoding, elements, body: body_start(bytes, text.at) })
}

/// The body starts after the end of the header's last line: LF, CR LF or CR. A binary body may start with any byte.
fn body_start(bytes: &[u8], after_word: usize) -> usize {
    let rest = &bytes[after_word..];
    let blanks = rest.iter().take_while(|&&b| b == b' ' || b == b'\t').count();
    after_word
        + match &rest[blanks..] {
            [b'\r', b'\n', ..] => blanks + 2,
            [b'\n' | b'\r', ..] => blanks + 1,
            _ => 0,
        }
}

/// Up to five words of a line, which is more than any line has.
fn words<'a>(text: &mut Text<'a>) -> [Option<&'a [u8]>; 5] {
    let words = [(); 5].map(|()| text.word_in_line());
    text.rest_of_line();
    words
}

struct Line<'a> {
    at: usize,
    words: [Option<&'a [u8]>; 5],
}

impl<'a> Line<'a> {
    fn read(
        &self,
        keyword: &[u8],
        encoding: &mut Option<Encoding>,
        elements: &mut Vec<Element<'a>>,
    ) -> Result<Result<()>, String> {
        Ok(match keyword {
            b"format" => {
                *encoding = Some(self.encoding()?);
                Ok(())
            }
            b"element" => grow::push(elements, self.element()?),
            b"property" => {
                let element = elements.last_mut().ok_or("a property before the first element")?;
                grow::push(&mut element.properties, self.property()?)
            }
            _ => return Err(format!("unknown header line '{}' (byte {})", shown(keyword), self.at)),
        })
    }

    fn encoding(&self) -> Result<Encoding, String> {
        let [Some(name), Some(b"1.0"), None, ..] = self.words else {
            return Err("expected 'format ENCODING 1.0'".to_owned());
        };
        match name {
            b"ascii" => Ok(Encoding::Ascii),
            b"binary_little_endian" => Ok(Encoding::LittleEndian),
            b"binary_big_endian" => Ok(Encoding::BigEndian),
            _ => Err(format!(
                "unknown encoding '{}'; the known ones are ascii, binary_little_endian, binary_big_endian",
                shown(name)
            )),
        }
    }

    fn element(&self) -> Result<Element<'a>, String> {
        let [Some(name), Some(count), None, ..] = self.words else {
            return Err("expected 'element NAME COUNT'".to_owned());
        };
        let number = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok());
        let count = number.ok_or_else(|| format!("'{}' is not a count of elements", shown(count)))?;
        Ok(Element { name, count, properties: Vec::new() })
    }

    fn property(&self) -> Result<Property<'a>, String> {
        let kind = |word| Scalar::named(word).ok_or_else(|| format!("unknown type '{}'", shown(word)));
        match self.words {
            [Some(b"list"), Some(length), Some(item), Some(name), None] => match kind(length)? {
                Scalar::F32 | Scalar::F64 => Err("the length of a list can't be a floating-point number".to_owned()),
                length => Ok(Property { name, list: Some(length), kind: kind(item)? }),
            },
            [Some(word), Some(name), None, ..] => Ok(Property { name, list: None, kind: kind(word)? }),
            _ => Err("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'".to_owned()),
        }
    }
}
