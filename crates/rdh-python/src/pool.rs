//! Threads to cast on.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::arrays::refuse;

/// More threads than any machine has; a call that asks for more is mistaken.
const MOST: usize = 1024;

/// The pools there are, by the process that made them and their size. A process that was forked has none of its parent's
/// threads, and would wait for them forever.
static POOLS: Mutex<BTreeMap<(u32, usize), Arc<ThreadPool>>> = Mutex::new(BTreeMap::new());

/// What `threads=` means: a pool of so many, or of as many as there are cores for `None` and 0.
///
/// # Errors
/// `ValueError` for a number that can't be meant; `RuntimeError` if the system won't start the threads.
pub(crate) fn pool(_attached: Python<'_>, threads: Option<i64>) -> PyResult<Arc<ThreadPool>> {
    let count = match threads {
        None | Some(0) => std::thread::available_parallelism().map_or(1, NonZeroUsize::get).min(MOST),
        Some(count) => usize::try_from(count).ok().filter(|n| *n <= MOST).ok_or_else(|| {
            refuse("threads", format_args!("{count} is not a number of threads: 1 to {MOST}, or 0 for all cores"))
        })?,
    };
    // Held only for a moment, and only by threads that are attached to Python; so none holds it while Python forks.
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let key = (std::process::id(), count);
    if let Some(pool) = pools.get(&key) {
        return Ok(Arc::clone(pool));
    }
    let name = |index: usize| format!("rdh-{index}");
    let pool = ThreadPoolBuilder::new().num_threads(count).thread_name(name).build();
    let pool = Arc::new(pool.map_err(|e| PyRuntimeError::new_err(format!("{count} threads can't be started: {e}")))?);
    pools.insert(key, Arc::clone(&pool));
    Ok(pool)
}
