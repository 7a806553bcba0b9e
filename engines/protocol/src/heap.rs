//! What is on the heap, for competitors that don't say how large they are.

/// Bytes that are allocated at the moment, or 0 where the system can't tell.
pub fn bytes() -> usize {
    imp::bytes()
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod imp {
    pub(super) fn bytes() -> usize {
        // SAFETY: the call takes no arguments, and only reads the allocator's own counters.
        let info = unsafe { libc::mallinfo2() };
        // Blocks of the heap, and large ones that were mapped by themselves.
        info.uordblks + info.hblkhd
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
mod imp {
    pub(super) fn bytes() -> usize {
        0
    }
}
