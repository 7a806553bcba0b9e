//! Counts what a thread allocates.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, counting. Growing a block counts as having both for a moment, which is the worst case.
pub(crate) struct Counting;

thread_local! {
    static LIVE: Cell<usize> = const { Cell::new(0) };
    static PEAK: Cell<usize> = const { Cell::new(0) };
}

#[expect(unsafe_code, reason = "an allocator can't be made otherwise; it passes everything on")]
// SAFETY: all calls go to `System` unchanged; the counters neither allocate nor run destructors.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.set(LIVE.get().wrapping_add(layout.size()));
        PEAK.set(PEAK.get().max(LIVE.get()));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        LIVE.set(LIVE.get().wrapping_sub(layout.size()));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(block, layout) }
    }
}

/// What a function returns, and how many bytes this thread had at most in addition while it ran.
pub(crate) fn peak_of<T>(run: impl FnOnce() -> T) -> (T, usize) {
    // Started afresh, so that what other code frees of older blocks can't hide anything.
    LIVE.set(0);
    PEAK.set(0);
    let result = run();
    (result, PEAK.get())
}

#[test]
fn the_peak_is_seen() {
    let (kept, peak) = peak_of(|| {
        drop(vec![1u8; 1_000_000]);
        vec![2u8; 300_000]
    });
    assert!((1_000_000..1_010_000).contains(&peak), "{peak}");
    drop(kept);
}
