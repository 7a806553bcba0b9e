//! CPU time: what a thread or the process has used, whatever else the machine does meanwhile.
//!
//! On systems without such clocks, elapsed time stands in.

pub use imp::{process_nanos, thread_nanos};

/// What `work` returns, and the calling thread's CPU time for it in seconds.
pub fn time_thread<T>(work: impl FnOnce() -> T) -> (T, f64) {
    time_by(thread_nanos, work)
}

/// What `work` returns, and the whole process's CPU time for it in seconds: for single-threaded work that may run on a
/// thread of its own. Nothing else may run meanwhile.
pub fn time_process<T>(work: impl FnOnce() -> T) -> (T, f64) {
    time_by(process_nanos, work)
}

fn time_by<T>(clock: fn() -> u64, work: impl FnOnce() -> T) -> (T, f64) {
    let start = clock();
    let result = work();
    (result, clock().saturating_sub(start) as f64 * 1e-9)
}

#[cfg(unix)]
mod imp {
    use rustix::time::{ClockId, clock_gettime};

    /// CPU time of the calling thread in nanoseconds, from an arbitrary start.
    pub fn thread_nanos() -> u64 {
        nanos(ClockId::ThreadCPUTime)
    }

    /// CPU time of all threads of the process in nanoseconds, from an arbitrary start.
    pub fn process_nanos() -> u64 {
        nanos(ClockId::ProcessCPUTime)
    }

    fn nanos(clock: ClockId) -> u64 {
        let time = clock_gettime(clock);
        time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
    }
}

#[cfg(not(unix))]
mod imp {
    use std::sync::LazyLock;
    use std::time::Instant;

    static START: LazyLock<Instant> = LazyLock::new(Instant::now);

    /// Elapsed time in nanoseconds, from an arbitrary start.
    pub fn thread_nanos() -> u64 {
        START.elapsed().as_nanos() as u64
    }

    /// Elapsed time in nanoseconds, from an arbitrary start.
    pub fn process_nanos() -> u64 {
        thread_nanos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_sleeping_thread_uses_no_time_and_a_busy_one_does() {
        let ((), asleep) = time_thread(|| std::thread::sleep(std::time::Duration::from_millis(30)));
        assert!(asleep < 0.02, "{asleep}");
        let (sum, busy) = time_thread(|| (0..3_000_000u64).fold(0, |s, x| std::hint::black_box(s ^ (x * x))));
        assert!(busy > 0.0 && sum != 1);
        let (_, elsewhere) = time_process(|| {
            std::thread::spawn(|| (0..3_000_000u64).fold(0, |s, x| std::hint::black_box(s ^ x))).join()
        });
        assert!(elsewhere > 0.0);
    }
}
