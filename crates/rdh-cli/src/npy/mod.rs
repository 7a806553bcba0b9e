//! NumPy's array files: rays in, answers out, row by row, so that they may be larger than memory.
//!
//! An own header: the `npyz` crate's recurses on what a file says and multiplies its shape unchecked, and would not read rows in blocks.

mod dict;
mod header;
mod rays;

pub(crate) use header::{Header, Number, write as write_header};
pub(crate) use rays::RayFile;
