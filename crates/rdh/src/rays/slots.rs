//! A place of its own for each thread, so that threads which record at the same time don't disturb each other.
//!
//! A thread leases a slot when it first records and returns it when it ends. While there are more threads than slots,
//! the late ones share the last one.

use std::cell::Cell;
use std::sync::{Mutex, PoisonError};

/// Slots that belong to one thread each.
const OWNED: usize = 127;
/// The slot that all further threads share.
pub(super) const SHARED: usize = OWNED;
/// How many there are.
pub(super) const COUNT: usize = OWNED + 1;

/// No slot yet.
const NONE: usize = usize::MAX;

/// The slots that are not leased: those that came back, and all from `next` on.
struct Free {
    returned: Vec<usize>,
    next: usize,
}

static FREE: Mutex<Free> = Mutex::new(Free { returned: Vec::new(), next: 0 });

thread_local! {
    // Without a destructor: reading it costs no more than a global variable.
    static SLOT: Cell<usize> = const { Cell::new(NONE) };
    static LEASE: Lease = Lease::take();
}

/// The calling thread's slot, below [`COUNT`]. No other living thread has it, unless it is [`SHARED`].
#[inline(always)]
pub(super) fn current() -> usize {
    match SLOT.get() {
        NONE => lease(),
        slot => slot,
    }
}

#[cold]
fn lease() -> usize {
    // A thread that is ending has lost its lease already.
    let slot = LEASE.try_with(|lease| lease.slot).unwrap_or(SHARED);
    SLOT.set(slot);
    slot
}

struct Lease {
    slot: usize,
}

impl Lease {
    fn take() -> Self {
        let mut free = FREE.lock().unwrap_or_else(PoisonError::into_inner);
        let slot = free.returned.pop().unwrap_or_else(|| {
            let slot = free.next.min(SHARED);
            free.next = slot + 1;
            slot
        });
        Self { slot }
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        SLOT.set(SHARED);
        if self.slot != SHARED {
            // The lock orders what this thread wrote before what the slot's next owner writes.
            FREE.lock().unwrap_or_else(PoisonError::into_inner).returned.push(self.slot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    #[test]
    fn living_threads_have_slots_of_their_own_until_these_run_out() {
        let threads = COUNT + 40;
        let barrier = Barrier::new(threads);
        let mut slots: Vec<usize> = std::thread::scope(|scope| {
            let one = || {
                let slot = current();
                barrier.wait();
                assert_eq!(slot, current());
                slot
            };
            let handles: Vec<_> = (0..threads).map(|_| scope.spawn(one)).collect();
            handles.into_iter().map(|h| h.join().unwrap()).collect()
        });
        slots.sort_unstable();
        assert!(slots.iter().all(|&s| s < COUNT));
        assert!(slots.windows(2).all(|w| w[0] < w[1] || w[0] == SHARED), "{slots:?}");
        assert!(slots.iter().filter(|&&s| s == SHARED).count() >= threads - OWNED);
    }

    #[test]
    fn slots_come_back() {
        for _ in 0..1000 {
            std::thread::spawn(current).join().unwrap();
        }
        let next = FREE.lock().unwrap().next;
        assert!(next <= COUNT);
        // The other test may hold all of them for a moment, hence not every thread must find one.
        let owned = (0..1000).filter(|_| std::thread::spawn(current).join().unwrap() != SHARED).count();
        assert!(owned > 0);
    }
}
