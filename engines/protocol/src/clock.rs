//! CPU time, whatever else the machine does meanwhile.

use rustix::time::{ClockId, clock_gettime};

/// CPU time of this thread in nanoseconds, from an arbitrary start.
pub fn thread_nanos() -> u64 {
    nanos(ClockId::ThreadCPUTime)
}

/// CPU time of all threads of this process in nanoseconds, from an arbitrary start.
pub fn process_nanos() -> u64 {
    nanos(ClockId::ProcessCPUTime)
}

fn nanos(clock: ClockId) -> u64 {
    let time = clock_gettime(clock);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}
