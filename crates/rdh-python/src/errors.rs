//! Rust's errors as Python's.

use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use pyo3::prelude::*;

/// An error of the library.
pub(crate) fn from_library(error: rdh::Error) -> PyErr {
    match error {
        rdh::Error::OutOfMemory { .. } => PyMemoryError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// An error of the readers and generators of scenes. That a file can't be opened is one of the system, and raises what
/// `open` would have raised.
pub(crate) fn from_scene(error: rdh_scene::Error) -> PyErr {
    if let Some(Err(system)) = error.file.as_ref().map(std::fs::File::open) {
        return from_system(error.file.as_deref(), system);
    }
    PyValueError::new_err(error.to_string())
}

/// An error of the operating system, with the file's name.
pub(crate) fn from_system(file: Option<&std::path::Path>, error: std::io::Error) -> PyErr {
    let name = file.map(|f| f.display().to_string());
    match error.raw_os_error() {
        // With a number, OSError turns into FileNotFoundError and the like, and says the number itself.
        Some(number) => {
            let text = error.to_string();
            let reason = text.strip_suffix(&format!(" (os error {number})")).unwrap_or(&text);
            PyOSError::new_err((number, reason.to_owned(), name))
        }
        None => PyOSError::new_err(format!("{}: {error}", name.unwrap_or_default())),
    }
}
