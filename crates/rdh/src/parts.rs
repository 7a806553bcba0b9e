//! The arrays that meshes and structures are made of, by name: as bytes that can be written, and out of bytes again.

use std::ops::Range;

use crate::error::{Error, Result};
use crate::mem::{Array, Bytes, Plain, bytes_of};

/// The name of an array. The numbers stand in files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub(crate) enum Part {
    /// The mesh's vertices: three f32.
    Positions = 1,
    /// The mesh's triangles: three u32.
    Triangles = 2,
    /// The mesh's masks: a u32 a triangle.
    Masks = 3,
    /// The root of a structure that keeps it apart.
    Root = 4,
    /// Nodes.
    Nodes = 5,
    /// Blocks of triangles.
    Blocks = 6,
    /// A profile, as in a `.rays` file: bytes.
    Unseen = 7,
}

impl Part {
    const ALL: [Self; 7] =
        [Self::Positions, Self::Triangles, Self::Masks, Self::Root, Self::Nodes, Self::Blocks, Self::Unseen];

    /// The part with this number.
    pub(crate) fn numbered(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|&part| part as u32 == number)
    }

    /// What it is called in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Triangles => "triangles",
            Self::Masks => "masks",
            Self::Root => "root",
            Self::Nodes => "nodes",
            Self::Blocks => "blocks of triangles",
            Self::Unseen => "unseen rays",
        }
    }
}

/// A byte of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) part: Part,
    pub(crate) byte: usize,
}

impl Place {
    /// Where an element begins.
    pub(crate) fn of<T>(part: Part, element: usize) -> Self {
        Self { part, byte: element * size_of::<T>() }
    }
}

/// A part to be written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Written<'a> {
    pub(crate) part: Part,
    /// Bytes of an element.
    pub(crate) stride: usize,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Written<'a> {
    /// An array as a part.
    pub(crate) fn new<T: Plain>(part: Part, data: &'a [T]) -> Self {
        Self { part, stride: size_of::<T>(), bytes: bytes_of(data) }
    }
}

/// A part to be read: where it lies, a whole number of elements.
#[derive(Debug, Clone)]
pub(crate) struct Listed {
    pub(crate) part: Part,
    /// Bytes of an element.
    pub(crate) stride: usize,
    pub(crate) range: Range<usize>,
}

/// Parts among bytes.
pub(crate) struct Parts<'a> {
    pub(crate) bytes: Bytes<'a>,
    /// Sorted by part, each at most once; the ranges lie within the bytes.
    pub(crate) listed: Vec<Listed>,
}

impl Parts<'_> {
    /// A part, if it is there.
    ///
    /// # Errors
    /// [`Error::Format`] if its elements have another size, or lack of memory.
    pub(crate) fn find<T: Plain>(&self, part: Part) -> Result<Option<Array<T>>> {
        let Some(listed) = self.listed.iter().find(|l| l.part == part) else { return Ok(None) };
        if listed.stride != size_of::<T>() {
            let reason = format!("{}: elements of {} bytes instead of {}", part.name(), listed.stride, size_of::<T>());
            return Err(Error::Format { offset: listed.range.start, reason });
        }
        self.bytes.array(listed.range.clone(), part.name()).map(Some)
    }

    /// A part that must be there.
    ///
    /// # Errors
    /// As [`Self::find`], and if it is missing.
    pub(crate) fn get<T: Plain>(&self, part: Part) -> Result<Array<T>> {
        let missing = || Error::Format { offset: 0, reason: format!("there are no {}", part.name()) };
        self.find(part)?.ok_or_else(missing)
    }

    /// An error at a byte of a part.
    pub(crate) fn error(&self, place: Place, reason: String) -> Error {
        let start = self.listed.iter().find(|l| l.part == place.part).map_or(0, |l| l.range.start);
        Error::Format { offset: start + place.byte, reason }
    }
}
