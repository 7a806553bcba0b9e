//! Typed views of buffers, every bound checked before the first element is read.

use super::Document;
use super::schema::{Shape, Sparse};
use crate::error::{Error, Result};

/// A list of elements of one or more numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accessor<'a> {
    /// How many elements there are.
    pub count: usize,
    pub shape: Shape,
    pub component: Component,
    pub normalized: bool,
    /// Without it, all numbers are zero.
    dense: Option<Strided<'a>>,
    sparse: Option<Patch<'a>>,
}

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// Elements at equal distances; all of them lie within `bytes`.
#[derive(Debug, Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// Elements that are replaced: `count` rising element numbers, and their values.
#[derive(Debug, Clone, Copy)]
struct Patch<'a> {
    count: usize,
    index_type: Component,
    indices: Strided<'a>,
    values: Strided<'a>,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Whether it is a plain index.
    pub(super) fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// The number at the start of some bytes.
    fn read(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::I8, [a, ..]) => f64::from(*a as i8),
            (Self::U8, [a, ..]) => f64::from(*a),
            (Self::I16, [a, b, ..]) => f64::from(i16::from_le_bytes([*a, *b])),
            (Self::U16, [a, b, ..]) => f64::from(u16::from_le_bytes([*a, *b])),
            (Self::U32, [a, b, c, d, ..]) => f64::from(u32::from_le_bytes([*a, *b, *c, *d])),
            (Self::F32, [a, b, c, d, ..]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            _ => unreachable!("bounds are checked when an accessor is opened"),
        }
    }

    /// A normalised integer as the fraction it stands for.
    fn fraction(self, x: f64) -> f64 {
        match self {
            Self::I8 => (x / 127.0).max(-1.0),
            Self::U8 => x / 255.0,
            Self::I16 => (x / 32767.0).max(-1.0),
            Self::U16 => x / 65535.0,
            Self::U32 | Self::F32 => x,
        }
    }
}

impl Shape {
    /// Numbers an element.
    fn len(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 | Self::Mat2 => 4,
            Self::Mat3 => 9,
            Self::Mat4 => 16,
        }
    }
}

impl Accessor<'_> {
    /// An element of `N` numbers, which the caller has found its shape to have; normalised integers as fractions.
    pub(super) fn get<const N: usize>(&self, element: usize) -> [f64; N] {
        let (source, at) = match self.sparse.and_then(|patch| Some((patch.values, patch.find(element)?))) {
            Some((values, at)) => (Some(values), at),
            None => (self.dense, element),
        };
        let Some(source) = source else { return [0.0; N] };
        let bytes = &source.bytes[at * source.stride..];
        std::array::from_fn(|number| {
            let x = self.component.read(&bytes[number * self.component.bytes()..]);
            if self.normalized { self.component.fraction(x) } else { x }
        })
    }
}

impl Patch<'_> {
    fn index(&self, at: usize) -> f64 {
        self.index_type.read(&self.indices.bytes[at * self.indices.stride..])
    }

    /// Where an element's replacement stands, if it has one: by bisection.
    fn find(&self, element: usize) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low.midpoint(high);
            if self.index(middle) < element as f64 { low = middle + 1 } else { high = middle }
        }
        (low < self.count && self.index(low) == element as f64).then_some(low)
    }
}

/// Opens an accessor.
///
/// # Errors
/// Whatever does not exist or does not fit, by accessor.
pub(super) fn open<'d>(document: &'d Document, index: u32) -> Result<Accessor<'d>> {
    let place = format!("accessor {index}");
    let reason = |reason: String| Error::at(place.clone(), reason);
    let accessor = document.root.accessors.get(index as usize).ok_or_else(|| reason("does not exist".to_owned()))?;
    let unknown = || reason(format!("unknown component type {}", accessor.component_type));
    let component = Component::of(accessor.component_type).ok_or_else(unknown)?;
    let count = usize::try_from(accessor.count).map_err(|e| reason(e.to_string()))?;
    let element = accessor.shape.len() * component.bytes();
    let window =
        |view, offset, count, element| strided(document, view, offset, count, element).map_err(place_first(&place));
    let dense = accessor.buffer_view.map(|view| window(view, accessor.byte_offset, count, element)).transpose()?;
    let sparse = match &accessor.sparse {
        Some(sparse) => Some(patch(document, sparse, count, element, &place)?),
        None => None,
    };
    Ok(Accessor { count, shape: accessor.shape, component, normalized: accessor.normalized, dense, sparse })
}

/// Names the accessor before the buffer or view that is at fault.
fn place_first(place: &str) -> impl Fn(Error) -> Error {
    move |e| e.within(place)
}

fn patch<'d>(document: &'d Document, sparse: &Sparse, count: usize, element: usize, place: &str) -> Result<Patch<'d>> {
    let reason = |reason: &str| Error::at(format!("{place}, sparse"), reason);
    // Its indices are looked at each time the accessor is opened.
    document.budget.spend(sparse.count, 1, place)?;
    let patches = usize::try_from(sparse.count).map_err(|e| reason(&e.to_string()))?;
    let index_type = Component::of(sparse.indices.component_type).filter(|c| c.is_unsigned());
    let index_type = index_type.ok_or_else(|| reason("the indices' component type must be an unsigned integer"))?;
    let window = |view, offset, element| strided(document, view, offset, patches, element).map_err(place_first(place));
    let indices = window(sparse.indices.buffer_view, sparse.indices.byte_offset, index_type.bytes())?;
    let values = window(sparse.values.buffer_view, sparse.values.byte_offset, element)?;
    let patch = Patch { count: patches, index_type, indices, values };
    let rise = (1..patches).all(|at| patch.index(at - 1) < patch.index(at));
    if !rise || patches > 0 && patch.index(patches - 1) >= count as f64 {
        return Err(reason("the indices must rise and stay below the accessor's count"));
    }
    Ok(patch)
}

/// The bytes of `count` elements of a view, from an offset on.
fn strided<'d>(document: &'d Document, view: u32, offset: u64, count: usize, element: usize) -> Result<Strided<'d>> {
    let place = format!("buffer view {view}");
    let reason = |reason: String| Error::at(place.clone(), reason);
    let about = document.root.buffer_views.get(view as usize).ok_or_else(|| reason("does not exist".to_owned()))?;
    let buffer = document.buffers.bytes(about.buffer, &document.root.buffers, &document.budget)?;
    let bytes = slice(buffer, about.byte_offset, about.byte_length).ok_or_else(|| {
        let (from, length) = (about.byte_offset, about.byte_length);
        reason(format!("{length} bytes from {from} on, but buffer {} has only {}", about.buffer, buffer.len()))
    })?;
    let stride = about.byte_stride.unwrap_or(element as u64);
    if stride < element as u64 {
        return Err(reason(format!("byte stride {stride} is less than an element's {element} bytes")));
    }
    let needed = match count.checked_sub(1) {
        None => Some(0),
        Some(gaps) => (gaps as u64).checked_mul(stride).and_then(|n| n.checked_add(element as u64)),
    };
    let bytes = needed.and_then(|needed| slice(bytes, offset, needed)).ok_or_else(|| {
        let length = bytes.len();
        reason(format!("{count} elements of {element} bytes, from {offset} on, don't fit into its {length} bytes"))
    })?;
    // It is no more than the bytes' length, or there is at most one element.
    Ok(Strided { bytes, stride: usize::try_from(stride).unwrap_or(0) })
}

fn slice(bytes: &[u8], from: u64, length: u64) -> Option<&[u8]> {
    let end = from.checked_add(length)?;
    bytes.get(usize::try_from(from).ok()?..usize::try_from(end).ok()?)
}
