//! What a build may use, and how it reports.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::error::{Error, Result};
use crate::simd::Level;

/// Limits and callbacks of a build. The default has no limits but those that keep a tree finite.
#[derive(Clone, Copy, Default)]
pub struct BuildOptions<'a> {
    /// How many threads may build; `None` is rayon's current pool. The result is the same on any number.
    pub threads: Option<usize>,
    /// At most so many references to triangles, not fewer than there are triangles. `None` is 8 times the triangles plus 1,000 for
    /// a kd-tree, whose subtrees that would need more become leaves; and 1½ times the triangles for a hierarchy that cuts triangles
    /// (`sbvh8`, `bvh8(from=kd)`), which never has more than that and cuts no further. Other hierarchies have one a triangle whatever
    /// stands here.
    pub max_refs: Option<usize>,
    /// At most so many bytes for the finished structure. Subtrees of a kd-tree that would need more become leaves, and if even a
    /// single leaf needs more, the build fails. A bounding volume hierarchy is built first and fails if it has become too large.
    pub max_bytes: Option<usize>,
    /// At most so many levels of a kd-tree; `None` is what the stop rule says (1.3 log2 N + 8, or 1.2 log2 N + 2 for
    /// `stop=paper`), never more than 64. A bounding volume hierarchy stops where leaves are small, and its binary tree has at
    /// most 64 levels whatever stands here.
    pub max_depth: Option<usize>,
    /// Which instructions build, and trace what is built; `None` is the best of this CPU. The result is the same with any: for tests
    /// and measurements.
    pub level: Option<Level>,
    /// Called now and then with the finished part of the work, 0 to 1; from any thread.
    pub progress: Option<&'a (dyn Fn(f64) + Sync)>,
    /// Asked often, from any thread: `true` stops the build with [`Error::Cancelled`](crate::Error::Cancelled). At 300,000
    /// triangles on one thread there is a question every 50 ms or so. That grows with the mesh, since the largest step is one over all
    /// triangles: at a million it is 50 ms for kd-trees and hierarchies by bins, 120 ms and more where triangles are cut, rays are
    /// counted or all is sorted.
    pub cancel: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl BuildOptions<'_> {
    /// The instructions that build.
    pub(crate) fn level(&self) -> Level {
        self.level.unwrap_or_else(Level::best)
    }
}

/// A build's callbacks, shared by its threads.
pub(crate) struct Watch<'a> {
    options: &'a BuildOptions<'a>,
    cancelled: AtomicBool,
    finished: AtomicU64,
    total: u64,
}

impl<'a> Watch<'a> {
    /// Over a build of `total` primitives.
    pub(crate) fn new(options: &'a BuildOptions<'a>, total: usize) -> Self {
        Self { options, cancelled: AtomicBool::new(false), finished: AtomicU64::new(0), total: total as u64 }
    }

    /// Asks whether to go on.
    pub(crate) fn check_cancelled(&self) -> Result<()> {
        if self.options.cancel.is_some_and(|cancel| cancel()) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        if self.cancelled.load(Ordering::Relaxed) { Err(Error::Cancelled) } else { Ok(()) }
    }

    /// Asks once in so many steps of a loop, to be called with the number of each.
    pub(crate) fn check_at(&self, step: usize) -> Result<()> {
        if step.is_multiple_of(Self::STEPS) { self.check_cancelled() } else { Ok(()) }
    }

    /// Steps between two questions: a millisecond or so of work on nodes.
    pub(crate) const STEPS: usize = 1024;

    /// Counts a leaf's references against the number of primitives. Perfect splits make more of the former, so progress
    /// runs ahead and then waits.
    pub(crate) fn report(&self, leaf: usize) {
        if let Some(progress) = self.options.progress {
            let before = self.finished.fetch_add(leaf as u64, Ordering::Relaxed);
            let step = (self.total / 100).max(1);
            if before / step != (before + leaf as u64) / step {
                progress(((before + leaf as u64) as f64 / self.total.max(1) as f64).min(1.0));
            }
        }
    }
}
