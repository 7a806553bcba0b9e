//! Finished arrays: they don't change any more, and whoever holds one keeps its memory, be it our own or somebody else's, such as
//! that of a mapped file. Reading one costs what reading a `Vec` costs; cloning it copies nothing.

use std::any::Any;
use std::fmt;
use std::ops::{Deref, Range};
use std::ptr::NonNull;
use std::sync::Arc;

use super::settled_bytes;
use crate::error::Result;

/// Plain data: numbers in which any bits are a value, without padding, pointers or interior mutability.
///
/// # Safety
/// An implementation must be all of this.
pub(crate) unsafe trait Plain: Copy + Send + Sync + 'static {}

// SAFETY: `Pod` demands the same.
unsafe impl<T: bytemuck::Pod + Send + Sync> Plain for T {}

/// A finished array.
#[derive(Clone)]
pub(crate) struct Array<T> {
    start: NonNull<T>,
    len: usize,
    /// Holds the memory in place, and gives no exclusive access to it.
    _owner: Arc<dyn Any + Send + Sync>,
}

// SAFETY: an array is a shared slice with its owner, which may be sent and shared itself.
unsafe impl<T: Send + Sync> Send for Array<T> {}
// SAFETY: as above.
unsafe impl<T: Send + Sync> Sync for Array<T> {}

impl<T: Send + Sync + 'static> From<Vec<T>> for Array<T> {
    fn from(vec: Vec<T>) -> Self {
        let owner = Arc::new(vec);
        Self { start: NonNull::from(owner.as_slice()).cast(), len: owner.len(), _owner: owner }
    }
}

impl<T: Send + Sync + 'static> Default for Array<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> Deref for Array<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: both come from a slice that lives in memory which `_owner` holds, and which nobody can write to.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T: fmt::Debug> fmt::Debug for Array<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: PartialEq> PartialEq for Array<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

/// The bytes of plain data.
pub(crate) fn bytes_of<T: Plain>(data: &[T]) -> &[u8] {
    // SAFETY: plain data has no padding, so each of its bytes is initialised.
    unsafe { std::slice::from_raw_parts(data.as_ptr().cast(), size_of_val(data)) }
}

/// What lends its bytes, unchanged for as long as it lives.
type Lender = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// Bytes that arrays can be made of.
pub(crate) enum Bytes<'a> {
    /// To be copied.
    Borrowed(&'a [u8]),
    /// To be shared.
    Lent(Lent),
}

/// Bytes and their lender.
pub(crate) struct Lent {
    start: NonNull<u8>,
    len: usize,
    lender: Lender,
}

impl Lent {
    /// Asks the lender once: it might say something else the next time.
    pub(crate) fn by(lender: Lender) -> Self {
        let bytes: &[u8] = (*lender).as_ref();
        Self { start: NonNull::from(bytes).cast(), len: bytes.len(), lender }
    }

    fn bytes(&self) -> &[u8] {
        // SAFETY: `as_ref` lent this for as long as the lender is borrowed. Holding it in an `Arc` is a borrow without end: it can
        // neither be dropped nor, but through a shared reference, be changed.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl Bytes<'_> {
    /// All of them.
    pub(crate) fn all(&self) -> &[u8] {
        match self {
            Self::Borrowed(bytes) => bytes,
            Self::Lent(lent) => lent.bytes(),
        }
    }

    /// An array of whole elements, in a range of the bytes: shared if they are lent and lie as the elements must, else copied.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory) where they are copied.
    ///
    /// # Panics
    /// If the range lies outside of the bytes.
    pub(crate) fn array<T: Plain>(&self, range: Range<usize>, what: &'static str) -> Result<Array<T>> {
        const { assert!(size_of::<T>() > 0, "elements have a size") };
        let bytes = &self.all()[range];
        let start = NonNull::from(bytes).cast::<T>();
        match self {
            Self::Lent(lent) if start.is_aligned() => {
                Ok(Array { start, len: bytes.len() / size_of::<T>(), _owner: Arc::new(lent.lender.clone()) })
            }
            _ => Ok(settled_bytes(bytes, what)?.into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_and_arrays_of_lent_bytes_share_memory() {
        let owned: Array<u32> = vec![1, 2, 3].into();
        assert_eq!(owned.clone().as_ptr(), owned.as_ptr());
        // A vector of words, so that its bytes lie as words must.
        struct Words(Vec<u64>);
        impl AsRef<[u8]> for Words {
            fn as_ref(&self) -> &[u8] {
                bytemuck::cast_slice(&self.0)
            }
        }
        let words = Arc::new(Words((0..100).collect()));
        let address = words.0.as_ptr() as usize;
        let lent = Bytes::Lent(Lent::by(words.clone()));
        let shared: Array<u32> = lent.array(8..24, "words").unwrap();
        let copied: Array<u32> = lent.array(9..25, "words").unwrap();
        drop(lent);
        assert_eq!(Arc::strong_count(&words), 2);
        drop(words);
        assert_eq!(
            (shared.as_ptr() as usize, &shared[..]),
            (address + 8, &[1u64, 2].map(|x| x.to_le() as u32).iter().flat_map(|&x| [x, 0]).collect::<Vec<_>>()[..])
        );
        assert!(copied.as_ptr() as usize != address + 9 && copied.len() == 4);
    }
}
