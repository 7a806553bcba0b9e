//! `rdh` for Python: a shell around the library, without logic of its own.
//!
//! Arrays are converted in `arrays.rs`, errors in `errors.rs`; threads, the interpreter's lock and Ctrl-C are dealt with in
//! `batch.rs`. Doc comments of what Python sees are its docstrings, and their examples are run by the tests.

mod arrays;
mod batch;
mod cast;
mod errors;
mod load;
mod pairs;
mod pool;
mod profile;
mod scene;
mod tune;
mod world;

/// The module `rdh._rdh`; the package `rdh` re-exports what is public in it.
#[pyo3::pymodule]
mod _rdh {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::load::{_from_bytes, _reopen, load, open};
    #[pymodule_export]
    use crate::pairs::{_any, _count, _first, _meetings};
    #[pymodule_export]
    use crate::profile::{Profile, Record, record};
    #[pymodule_export]
    use crate::scene::Scene;

    #[pymodule_export]
    const INVALID_ID: u32 = crate::cast::INVALID_ID;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
