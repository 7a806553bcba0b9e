//! In tests: an allocator seam that refuses, and an allocator that counts.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

thread_local! {
    /// How many more requests of this thread's work are granted; nothing while all are.
    static GRANTS: RefCell<Option<Arc<AtomicI64>>> = const { RefCell::new(None) };
    /// Bytes that this thread has taken, less those that it has given back.
    static TAKEN: Cell<isize> = const { Cell::new(0) };
}

/// Whether this request is refused: the one after the last that is granted, and all others after it.
pub(super) fn refuses() -> bool {
    GRANTS.with_borrow(|grants| grants.as_ref().is_some_and(|left| left.fetch_sub(1, Ordering::Relaxed) <= 0))
}

/// What `work` returns where all its requests but the first `grants` are refused, and how many it made. With more than one thread
/// it runs in a pool of its own.
pub(crate) fn with_grants<T: Send>(grants: i64, threads: usize, work: impl FnOnce() -> T + Send) -> (T, i64) {
    let left = Arc::new(AtomicI64::new(grants));
    let limit = || GRANTS.set(Some(left.clone()));
    let result = match threads {
        1 => {
            limit();
            let result = work();
            GRANTS.set(None);
            result
        }
        _ => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let shared = left.clone();
            let pool = pool.start_handler(move |_| GRANTS.set(Some(shared.clone())));
            pool.build().expect("threads").install(work)
        }
    };
    (result, grants - left.load(Ordering::Relaxed))
}

/// Bytes that this thread holds.
pub(crate) fn taken() -> isize {
    TAKEN.get()
}

/// The system's allocator, counted.
struct Counted;

#[global_allocator]
static COUNTED: Counted = Counted;

fn count(bytes: isize) {
    TAKEN.set(TAKEN.get() + bytes);
}

// SAFETY: everything is passed on to the system's allocator as it came; counting allocates nothing, and neither does a thread's
// counter, which is made of a constant and needs no destructor.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: as the caller promises.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(start, layout) }
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(start, layout, size) }
    }
}

#[test]
fn grants_run_out_and_bytes_are_counted() {
    let ask = || super::reserve(&mut Vec::<u64>::new(), 5, "numbers").is_ok();
    assert_eq!(with_grants(2, 1, || [ask(), ask(), ask(), ask()]), ([true, true, false, false], 4));
    assert_eq!(with_grants(1, 2, || [ask(), ask()]), ([true, false], 2));
    assert!(ask(), "others are not refused");
    let before = taken();
    let vec: Vec<u64> = Vec::with_capacity(100);
    assert_eq!(taken() - before, 800);
    drop(vec);
    assert_eq!(taken(), before);
}
