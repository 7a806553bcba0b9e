//! How much memory this process uses, for competitors that don't say how large they are.

/// Bytes of the pages that are really in use at the moment, or 0 where the system doesn't tell.
pub fn resident_bytes() -> usize {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split(' ').nth(1).and_then(|pages| pages.parse().ok());
    pages.unwrap_or(0usize) * rustix::param::page_size()
}
