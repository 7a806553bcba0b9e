//! What can make a whole study impossible. What goes wrong with one scene is a [`Failure`](crate::Failure) instead.

use std::io;
use std::path::{Path, PathBuf};

/// Why a study can't be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The plan asks for nothing, or for something that makes no sense.
    #[error("{0}")]
    Plan(String),
    /// An unknown name of a mode or protocol.
    #[error("unknown {what} '{name}'; known: {known}")]
    UnknownName {
        /// What was to be named: "mode" or "protocol".
        what: &'static str,
        /// The name as given.
        name: String,
        /// The known names.
        known: &'static str,
    },
    /// A file of a study can't be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file of a study is there, and is not what it should be.
    #[error("{}: {reason}", path.display())]
    Content {
        /// Which file.
        path: PathBuf,
        /// Where in it, and what is wrong.
        reason: String,
    },
    /// Runs of the same job don't agree on their counts.
    #[error("{0}")]
    Disagreement(String),
    /// Threads could not be started.
    #[error("{count} threads could not be started: {reason}")]
    Threads {
        /// How many were asked for.
        count: usize,
        /// What the system says.
        reason: String,
    },
}

impl Error {
    /// Says of a system's error which file it concerns: `map_err(Error::file(path))`.
    pub(crate) fn file(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        move |source| Self::File { path: path.to_owned(), source }
    }
}

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;
