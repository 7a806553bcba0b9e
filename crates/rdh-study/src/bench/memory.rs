//! How much memory there is for the programs of engines.

/// Assumed where the system doesn't say: enough for the scenes of an ordinary race, one engine at a time for large ones.
const ASSUMED: u64 = 8 << 30;

/// Seven tenths of what is available.
pub(crate) fn usable_bytes() -> u64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    available_bytes(&text).unwrap_or(ASSUMED) / 10 * 7
}

fn available_bytes(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_linux_says_is_understood() {
        let text = "MemTotal:       24689664 kB\nMemFree:         9000000 kB\nMemAvailable:   20000000 kB\n";
        assert_eq!(available_bytes(text), Some(20_480_000_000));
        assert_eq!(available_bytes("MemAvailable: many kB"), None);
        assert_eq!(available_bytes(""), None);
    }
}
