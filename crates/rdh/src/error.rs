//! One error type that says which triangle, ray or byte is at fault.

/// What can go wrong in the library.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A vertex has a coordinate that is not finite.
    #[error("vertex {vertex}: coordinate {axis} is {value}, not a finite number")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// Which coordinate: 0, 1 or 2.
        axis: usize,
        /// The offending value.
        value: f32,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle}: vertex index {index} is out of range (the mesh has {vertices} vertices)")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The offending vertex index.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More triangles or vertices than 32-bit ids can name.
    #[error("{what}: {count} is more than the {limit} that can be numbered")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A table that goes with the mesh has the wrong length.
    #[error("{what}: {got} entries, but {expected} are needed")]
    WrongLength {
        /// Which table.
        what: &'static str,
        /// Its length.
        got: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A spec that can't be understood.
    #[error("spec '{spec}': {reason}")]
    Spec {
        /// The text as given.
        spec: String,
        /// What is wrong, and what is known instead.
        reason: String,
    },
    /// A ray heuristic was asked for without rays.
    #[error("'{spec}' needs a profile of rays, but the training set is empty")]
    NoRays {
        /// The spec that needs them.
        spec: String,
    },
    /// A build went over one of its budgets.
    #[error("the build needs more than {limit} {what}")]
    OverBudget {
        /// What ran out: "bytes" or "references".
        what: &'static str,
        /// The budget.
        limit: usize,
    },
    /// A build took longer than it may.
    #[error("'{spec}' takes more than {secs} s to build")]
    TooSlow {
        /// What was built.
        spec: String,
        /// The limit.
        secs: f64,
    },
    /// A choice that can't be made.
    #[error("nothing can be chosen: {reason}")]
    Tuning {
        /// What makes no sense, or could not be built.
        reason: String,
    },
    /// Memory could not be had.
    #[error("out of memory: {bytes} bytes for {what} could not be allocated")]
    OutOfMemory {
        /// What it was for.
        what: &'static str,
        /// How much was asked for.
        bytes: usize,
    },
    /// The caller's callback stopped the work.
    #[error("cancelled")]
    Cancelled,
    /// Profiles that can't be merged.
    #[error("profile {profile} was sampled with seed {seed}, the first one with seed {expected}: they can't be merged")]
    SeedMismatch {
        /// Which profile, counted from 0.
        profile: usize,
        /// Its seed.
        seed: u64,
        /// The seed of the first one.
        expected: u64,
    },
    /// Bytes that are not what they claim to be.
    #[error("byte {offset}: {reason}")]
    Format {
        /// Where in the data.
        offset: usize,
        /// What is wrong there.
        reason: String,
    },
}

/// The library's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;
