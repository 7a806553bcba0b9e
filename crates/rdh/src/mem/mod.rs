//! Memory: fallible allocation, large pages, arrays that may lie in a mapped file, and buffers that are not cleared before use.
#![allow(
    unsafe_code,
    reason = "uninitialised buffers, shared memory and advice about pages are the purpose of this module"
)]

mod array;
#[cfg(test)]
pub(crate) mod failing;
mod settled;
mod stack;

pub(crate) use array::{Array, Bytes, Lent, Plain, bytes_of};
pub(crate) use settled::{joined, made, settled_bytes};
pub(crate) use stack::{Slots, Stack};

use crate::error::{Error, Result};

/// Plain data, all zero: written by nobody, so that it costs nothing until it is used, and then on the thread that uses it.
pub(crate) fn zeroed<T: bytemuck::Zeroable>(len: usize, what: &'static str) -> Result<Vec<T>> {
    let none = none::<T>(len, what);
    if refused() {
        return Err(none);
    }
    bytemuck::allocation::try_zeroed_vec(len).map_err(|()| none)
}

/// Makes room for `additional` more elements, or says that there is none. The one allocator seam of the builders, with [`zeroed`] and
/// the finished arrays' own.
pub(crate) fn reserve<T>(vec: &mut Vec<T>, additional: usize, what: &'static str) -> Result<()> {
    if refused() {
        return Err(none::<T>(additional, what));
    }
    vec.try_reserve(additional).map_err(|_| none::<T>(additional, what))
}

/// Makes room for `len` elements in all.
pub(crate) fn reserve_all<T>(vec: &mut Vec<T>, len: usize, what: &'static str) -> Result<()> {
    let additional = len.saturating_sub(vec.len());
    reserve(vec, additional, what)
}

/// There is no room for so many.
fn none<T>(len: usize, what: &'static str) -> Error {
    Error::OutOfMemory { what, bytes: len.saturating_mul(size_of::<T>()) }
}

/// Whether a test wants this request to be refused.
#[cfg(test)]
fn refused() -> bool {
    failing::refuses()
}

#[cfg(not(test))]
#[inline(always)]
fn refused() -> bool {
    false
}
