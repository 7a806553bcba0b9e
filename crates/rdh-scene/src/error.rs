//! Reader errors: which file, where in it, what.

use std::fmt;
use std::path::PathBuf;

/// Why a scene could not be read or made.
#[derive(Debug)]
pub struct Error {
    /// The file, where one is known.
    pub file: Option<PathBuf>,
    /// Where in it: "line 12", "byte 80", "node 3"; empty for the whole file.
    pub place: String,
    /// What is wrong there.
    pub reason: String,
}

impl Error {
    /// An error at a place in data whose file the caller will add.
    pub fn at(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { file: None, place: place.into(), reason: reason.into() }
    }

    /// An error of the whole data.
    pub fn whole(reason: impl Into<String>) -> Self {
        Self::at("", reason)
    }

    /// Says what the place is a part of: "mesh 2" before "primitive 0".
    pub fn within(mut self, place: impl fmt::Display) -> Self {
        let separator = if self.place.is_empty() { "" } else { ", " };
        self.place = format!("{place}{separator}{}", self.place);
        self
    }

    /// Says which file it was, unless that is known already.
    pub fn in_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.file.get_or_insert_with(|| file.into());
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{}: ", file.display())?;
        }
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.reason)
    }
}

impl std::error::Error for Error {}

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;
