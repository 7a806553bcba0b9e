//! What a build may use, and how it reports.

/// Limits and callbacks of a build. The default has no limits but those that keep a tree finite.
#[derive(Clone, Copy, Default)]
pub struct BuildOptions<'a> {
    /// How many threads may build; `None` is rayon's current pool. The result is the same on any number.
    pub threads: Option<usize>,
    /// At most so many references to triangles; `None` is 8 times the triangles plus 1,000. Subtrees that would need
    /// more become leaves.
    pub max_refs: Option<usize>,
    /// At most so many bytes for the finished structure. Subtrees that would need more become leaves; if even
    /// a single leaf needs more, the build fails.
    pub max_bytes: Option<usize>,
    /// At most so many levels; `None` is what the stop rule says (1.3 log2 N + 8, or 1.2 log2 N + 2 for `stop=paper`),
    /// never more than 64.
    pub max_depth: Option<usize>,
    /// Called now and then with the finished part of the work, 0 to 1; from any thread.
    pub progress: Option<&'a (dyn Fn(f64) + Sync)>,
    /// Asked often, from any thread: `true` stops the build with [`Error::Cancelled`](crate::Error::Cancelled).
    pub cancel: Option<&'a (dyn Fn() -> bool + Sync)>,
}
