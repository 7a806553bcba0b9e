//! Memory: fallible allocation, large pages, arrays that may lie in a mapped file, and buffers that are not cleared before use.
#![allow(
    unsafe_code,
    reason = "uninitialised buffers, shared memory and advice about pages are the purpose of this module"
)]

mod array;
mod settled;
mod stack;

pub(crate) use array::{Array, Bytes, Lent, Plain, bytes_of};
pub(crate) use settled::{joined, settled_bytes};
pub(crate) use stack::{Slots, Stack};

use crate::error::{Error, Result};

/// Plain data, all zero: written by nobody, so that it costs nothing until it is used, and then on the thread that uses it.
pub(crate) fn zeroed<T: bytemuck::Zeroable>(len: usize, what: &'static str) -> Result<Vec<T>> {
    let bytes = len.saturating_mul(size_of::<T>());
    bytemuck::allocation::try_zeroed_vec(len).map_err(|()| Error::OutOfMemory { what, bytes })
}

/// Makes room for `additional` more elements, or says that there is none. The one allocator seam of the builders.
pub(crate) fn reserve<T>(vec: &mut Vec<T>, additional: usize, what: &'static str) -> Result<()> {
    let bytes = additional.saturating_mul(size_of::<T>());
    vec.try_reserve(additional).map_err(|_| Error::OutOfMemory { what, bytes })
}
