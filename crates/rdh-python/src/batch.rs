//! Many rays at once: shared among threads, without the interpreter's lock, and stopped by Ctrl-C.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::ThreadPool;
use rayon::prelude::*;

/// Rays that one thread takes at a time: so few that it soon asks again whether to go on.
const CHUNK: usize = 512;
/// How long Ctrl-C may go unnoticed.
const PATIENCE: Duration = Duration::from_millis(50);

/// Whether somebody wants the work stopped.
pub(crate) struct Cancel(AtomicBool);

impl Cancel {
    /// Whether to stop.
    pub(crate) fn is_wanted(&self) -> bool {
        self.0.load(Relaxed)
    }
}

/// Does `work` in the pool, while this thread looks out for signals. Python's other threads go on meanwhile.
///
/// # Errors
/// What the signal's handler raises, usually `KeyboardInterrupt`.
pub(crate) fn supervise<T: Send>(py: Python<'_>, pool: &ThreadPool, work: impl FnOnce(&Cancel) -> T + Send) -> PyResult<T> {
    py.detach(|| {
        let cancel = Cancel(AtomicBool::new(false));
        let (finished, result) = mpsc::sync_channel(1);
        let mut raised = None;
        let done = pool.in_place_scope(|scope| {
            let cancel = &cancel;
            // Nobody is there to hear it only if this scope is unwinding.
            scope.spawn(move |_| drop(finished.send(work(cancel))));
            loop {
                match result.recv_timeout(PATIENCE) {
                    Ok(done) => return Some(done),
                    // The work panicked; so will this scope.
                    Err(RecvTimeoutError::Disconnected) => return None,
                    Err(RecvTimeoutError::Timeout) => {}
                }
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    cancel.0.store(true, Relaxed);
                    raised.get_or_insert(error);
                }
            }
        });
        match (raised, done) {
            (Some(error), _) => Err(error),
            (None, Some(done)) => Ok(done),
            (None, None) => unreachable!("a scope whose work panicked does not return"),
        }
    })
}

/// Results with a row a ray, that can be shared out.
pub(crate) trait Columns: Send {
    /// Takes off the first `rows` rows.
    fn take(&mut self, rows: usize) -> Self;
}

impl<T: Send> Columns for &mut [T] {
    fn take(&mut self, rows: usize) -> Self {
        self.split_off_mut(..rows).unwrap_or_default()
    }
}

/// Does `work` for all of `count` rays, chunk by chunk, each with its part of the columns.
///
/// # Errors
/// As [`supervise`].
pub(crate) fn fill<C: Columns>(
    py: Python<'_>,
    pool: &ThreadPool,
    count: usize,
    mut columns: C,
    work: impl Fn(Range<usize>, C) + Sync,
) -> PyResult<()> {
    if count <= CHUNK {
        py.detach(|| work(0..count, columns));
        return Ok(());
    }
    let chunks: Vec<(Range<usize>, C)> = chunks(count).map(|chunk| (chunk.clone(), columns.take(chunk.len()))).collect();
    supervise(py, pool, |cancel| {
        chunks.into_par_iter().filter(|_| !cancel.is_wanted()).for_each(|(rays, columns)| work(rays, columns));
    })
}

/// Does `work` for all of `count` rays, chunk by chunk, and keeps what it returns, in order.
///
/// # Errors
/// As [`supervise`].
pub(crate) fn map<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    count: usize,
    work: impl Fn(Range<usize>) -> T + Sync + Send,
) -> PyResult<Vec<T>> {
    if count <= CHUNK {
        return Ok(vec![py.detach(|| work(0..count))]);
    }
    let chunks: Vec<Range<usize>> = chunks(count).collect();
    supervise(py, pool, |cancel| chunks.into_par_iter().filter(|_| !cancel.is_wanted()).map(&work).collect())
}

fn chunks(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(CHUNK).map(move |first| first..count.min(first + CHUNK))
}
