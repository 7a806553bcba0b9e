//! This machine.

use std::fs;

/// This machine in words, as far as the system tells.
pub(crate) fn name() -> String {
    let cpu = fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| model(&text));
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let cores = if cores > 0 { format!("{cores} threads, ") } else { String::new() };
    format!("{}, {cores}{system}", cpu.unwrap_or_else(|| "unknown processor".to_owned()))
}

fn model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_named() {
        assert_eq!(model("flags : a\nmodel name\t: Fast CPU @ 2 GHz\n"), Some("Fast CPU @ 2 GHz".to_owned()));
        assert_eq!(model("Hardware : board"), None);
    }
}
