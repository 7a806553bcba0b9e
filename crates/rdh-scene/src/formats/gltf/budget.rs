//! A limit on what a file can make us do.
//!
//! glTF refers to the same bytes from as many places as it likes, so that a small file can ask for a huge scene: ten
//! thousand meshes over one buffer, or a million empty nodes of three bytes each. What is unpacked is therefore charged
//! to a budget that is generous (12 times the input, and 48 MiB) and not to be exceeded.

use std::cell::Cell;

use crate::error::{Error, Result};

/// Bytes of memory, or of work, that may still be spent.
#[derive(Debug)]
pub(super) struct Budget {
    left: Cell<u64>,
}

impl Budget {
    /// The budget of a file of that size.
    pub(super) fn of(input_bytes: usize) -> Self {
        let budget = Self { left: Cell::new(48 << 20) };
        budget.grow(input_bytes);
        budget
    }

    /// More input has been read.
    pub(super) fn grow(&self, input_bytes: usize) {
        self.left.set(self.left.get().saturating_add((input_bytes as u64).saturating_mul(12)));
    }

    /// Spends some of it.
    ///
    /// # Errors
    /// The budget is exceeded, at the place that is given.
    pub(super) fn spend(&self, count: u64, bytes_each: u64, place: &str) -> Result<()> {
        let rest = count.checked_mul(bytes_each).and_then(|bytes| self.left.get().checked_sub(bytes));
        let too_much = || Error::at(place, "unpacks to far more data than the file has; is it damaged?");
        self.left.set(rest.ok_or_else(too_much)?);
        Ok(())
    }
}
