//! Many rays at once: shared among threads, without the interpreter's lock, and stopped by Ctrl-C.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::ThreadPool;
use rayon::prelude::*;

/// So many rays are cast one by one before it is asked again whether to go on, …
const STRIDE: usize = 512;
/// … and so many if all are cast at once: several rows of most pictures.
const BATCH: usize = 1 << 14;
/// Rays that one thread takes at a time, at most.
const WINDOW: usize = 1 << 16;
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
pub(crate) fn supervise<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    work: impl FnOnce(&Cancel) -> T + Send,
) -> PyResult<T> {
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

/// Some of a batch's rays, which one thread casts.
pub(crate) struct Window<'a> {
    rays: Range<usize>,
    cancel: Option<&'a Cancel>,
}

impl Window<'_> {
    /// How many rays there are.
    pub(crate) fn len(&self) -> usize {
        self.rays.len()
    }

    /// Does `work` for a few rays at a time, with their rows in the window and the number of the first one in the batch; stops if that
    /// is wanted.
    #[inline]
    pub(crate) fn strides(&self, work: impl FnMut(Range<usize>, usize)) {
        self.pieces(STRIDE, work);
    }

    /// The same for many rays at a time, which are to be cast at once.
    #[inline]
    pub(crate) fn batches(&self, work: impl FnMut(Range<usize>, usize)) {
        self.pieces(BATCH, work);
    }

    #[inline]
    fn pieces(&self, most: usize, mut work: impl FnMut(Range<usize>, usize)) {
        for from in (0..self.len()).step_by(most) {
            if self.cancel.is_some_and(Cancel::is_wanted) {
                return;
            }
            work(from..self.len().min(from + most), self.rays.start + from);
        }
    }

    /// Does `work` for each ray, with its row in the window and its number in the batch; stops if that is wanted.
    #[inline]
    pub(crate) fn each(&self, mut work: impl FnMut(usize, usize)) {
        self.strides(|rows, first| rows.zip(first..).for_each(|(row, ray)| work(row, ray)));
    }
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

/// Does `work` for all rays, window by window, each with its part of the columns.
///
/// # Errors
/// As [`supervise`].
pub(crate) fn fill<C: Columns>(
    py: Python<'_>,
    pool: &ThreadPool,
    count: usize,
    mut columns: C,
    work: impl Fn(&Window<'_>, C) + Sync,
) -> PyResult<()> {
    if count <= STRIDE {
        py.detach(|| work(&Window { rays: 0..count, cancel: None }, columns));
        return Ok(());
    }
    let parts = windows(count, pool).map(|window| (window.clone(), columns.take(window.len())));
    let parts: Vec<(Range<usize>, C)> = parts.collect();
    supervise(py, pool, |cancel| {
        let open = parts.into_par_iter().filter(|_| !cancel.is_wanted());
        open.for_each(|(window, columns)| work(&Window { rays: window, cancel: Some(cancel) }, columns));
    })
}

/// Does `work` for all rays, window by window, and keeps what it returns, in the order of the rays.
///
/// # Errors
/// As [`supervise`].
pub(crate) fn map<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    count: usize,
    work: impl Fn(&Window<'_>) -> T + Sync + Send,
) -> PyResult<Vec<T>> {
    if count <= STRIDE {
        return Ok(vec![py.detach(|| work(&Window { rays: 0..count, cancel: None }))]);
    }
    let parts: Vec<Range<usize>> = windows(count, pool).collect();
    supervise(py, pool, |cancel| {
        let open = parts.into_par_iter().filter(|_| !cancel.is_wanted());
        open.map(|window| work(&Window { rays: window, cancel: Some(cancel) })).collect()
    })
}

/// Windows over so many rays: many a thread, so that all end at about the same time.
fn windows(count: usize, pool: &ThreadPool) -> impl Iterator<Item = Range<usize>> + use<> {
    let window = count.div_ceil(8 * pool.current_num_threads()).clamp(STRIDE, WINDOW);
    (0..count).step_by(window).map(move |first| first..count.min(first + window))
}
