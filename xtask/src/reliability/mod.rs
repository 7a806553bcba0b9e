//! `cargo xtask reliability`: what is promised, how it is tested, and what came of it the last time, as a page of docs.
//!
//! Every check keeps its result in `target/reliability`, one file each; the page is made from these alone, so it says nothing that was
//! not found out. A check that wasn't run says so.

mod page;
mod promises;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};

pub(crate) use page::grouped;
use promises::TESTS;

/// Write docs/reliability.md from what checks have found out.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Run the ordinary tests that it names first; the long checks (soak, deep, fuzz) are run by themselves
    #[arg(long)]
    tests: bool,
    /// Cargo's profile for them
    #[arg(long, default_value = "release")]
    profile: String,
    /// Where the page goes
    #[arg(short, long, default_value = "docs/reliability.md")]
    output: PathBuf,
}

/// Whether no check has failed the last time.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    if arguments.tests {
        TESTS.iter().try_for_each(|test| run_test(test, &arguments.profile).map(drop))?;
    }
    let page = page::Page::of(&folder()?)?;
    let path = crate::root().join(&arguments.output);
    std::fs::write(&path, page.text()).with_context(|| path.display().to_string())?;
    Ok(page.is_clean())
}

/// Where results are kept.
pub(crate) fn folder() -> Result<PathBuf> {
    let folder = crate::target()?.join("reliability");
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}

/// What came of a check.
pub(crate) enum Verdict<'a> {
    Fine,
    Failed(&'a str),
    Skipped(&'a str),
}

/// Keeps what came of a check: how much was checked, in words, and the result.
pub(crate) fn keep(check: &str, count: &str, result: &Verdict<'_>) -> Result<()> {
    let (word, why) = match result {
        Verdict::Fine => ("fine", ""),
        Verdict::Failed(why) => ("failed", *why),
        Verdict::Skipped(why) => ("skipped", *why),
    };
    let record =
        json!({ "check": check, "count": count, "result": word, "why": why, "date": today(), "machine": machine() });
    let path = folder()?.join(format!("{check}.record.json"));
    std::fs::write(&path, record.to_string()).with_context(|| path.display().to_string())
}

/// Runs one of the ordinary tests by its name, keeps what came of it, and says whether it passed.
pub(crate) fn test(name: &str, profile: &str) -> Result<bool> {
    let test = TESTS.iter().find(|test| test.name == name).with_context(|| format!("there is no test {name}"))?;
    run_test(test, profile)
}

/// Runs one of the ordinary tests, by cargo's arguments: whether it passed.
fn run_test(test: &promises::Test, profile: &str) -> Result<bool> {
    eprintln!("{}", test.name);
    let mut command = Command::new("cargo");
    command.args(["test", "--quiet", "--profile", profile]).args(test.arguments);
    let output = command.current_dir(crate::root()).output().context("cargo")?;
    let text = String::from_utf8_lossy(&output.stdout);
    let passed: u64 = text.lines().filter_map(passed).sum();
    let count = if passed == 1 { "1 test".to_owned() } else { format!("{passed} tests") };
    if output.status.success() {
        ensure!(passed > 0, "{}: no test has this name", test.name);
        return keep(test.name, &count, &Verdict::Fine).map(|()| true);
    }
    eprintln!("{text}{}", String::from_utf8_lossy(&output.stderr));
    keep(test.name, &count, &Verdict::Failed("a test failed")).map(|()| false)
}

/// Of `test result: ok. 12 passed; …`.
fn passed(line: &str) -> Option<u64> {
    line.strip_prefix("test result: ")?.split_whitespace().nth(1)?.parse().ok()
}

/// The date, UTC, as 2026-01-31.
pub(crate) fn today() -> String {
    let secs = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_secs());
    let (year, month, day) = civil(secs / 86_400);
    format!("{year}-{month:02}-{day:02}")
}

/// Year, month and day of a day since 1970 (H. Hinnant, chrono-compatible low-level date algorithms: `civil_from_days`).
fn civil(days: u64) -> (u64, u64, u64) {
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (era * 400 + year + u64::from(month <= 2), month, day)
}

/// What the processor calls itself, where that can be found out.
fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |name| name.trim().to_owned())
}

/// A kept file, if the check was run.
fn read(path: &Path) -> Result<Option<Value>> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Some(serde_json::from_str(&text).with_context(|| path.display().to_string())?)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(e).with_context(|| path.display().to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        assert_eq!(civil(0), (1970, 1, 1));
        assert_eq!(civil(19_782), (2024, 2, 29));
        assert_eq!(civil(20_786), (2026, 11, 29));
        assert_eq!(civil(11_016), (2000, 2, 29));
    }

    #[test]
    fn passed_tests_are_counted() {
        assert_eq!(passed("test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured"), Some(12));
        assert_eq!(passed("running 12 tests"), None);
    }
}
