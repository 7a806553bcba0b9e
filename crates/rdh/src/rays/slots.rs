//! A place of its own for each thread, so that threads which record at the same time don't disturb each other.
//!
//! A thread leases a slot when it first records and returns it when it ends. While there are more threads than slots,
//! the late ones share the last one.

use std::cell::Cell;
use std::sync::{Mutex, PoisonError};

/// Slots that belong to one thread each.
pub(super) const OWNED: usize = 127;

/// No slot of its own: the thread shares one with others.
const SHARED: usize = OWNED;
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

/// The calling thread's slot, which no other living thread has; [`OWNED`] or more if it has none of its own, or none yet.
#[inline(always)]
pub(super) fn current() -> usize {
    SLOT.get()
}

/// Gets a thread that has none yet a slot, if there is one.
pub(super) fn lease() {
    if current() == NONE {
        // A thread that is ending has lost its lease already.
        SLOT.set(LEASE.try_with(|lease| lease.slot).unwrap_or(SHARED));
    }
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

    fn leased() -> usize {
        lease();
        current()
    }

    #[test]
    fn living_threads_have_slots_of_their_own_until_these_run_out() {
        let threads = OWNED + 40;
        let barrier = Barrier::new(threads);
        let mut slots: Vec<usize> = std::thread::scope(|scope| {
            let one = || {
                let slot = leased();
                barrier.wait();
                assert_eq!(slot, current());
                slot
            };
            let handles: Vec<_> = (0..threads).map(|_| scope.spawn(one)).collect();
            handles.into_iter().map(|h| h.join().unwrap()).collect()
        });
        slots.sort_unstable();
        assert!(slots.iter().all(|&s| s <= SHARED));
        assert!(slots.windows(2).all(|w| w[0] < w[1] || w[0] == SHARED), "{slots:?}");
        assert!(slots.iter().filter(|&&s| s == SHARED).count() >= threads - OWNED);
    }

    #[test]
    fn slots_come_back() {
        // The other test may hold all of them for a moment, hence not every thread must find one.
        let owned = (0..1000).filter(|_| std::thread::spawn(leased).join().unwrap() < OWNED).count();
        assert!(owned > OWNED, "{owned}");
    }
}
