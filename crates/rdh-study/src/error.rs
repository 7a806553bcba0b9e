//! What can make a whole study impossible. What goes wrong with one scene is a [`Failure`](crate::Failure) instead.

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
    /// Threads could not be started.
    #[error("{count} threads could not be started: {reason}")]
    Threads {
        /// How many were asked for.
        count: usize,
        /// What the system says.
        reason: String,
    },
}

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;
