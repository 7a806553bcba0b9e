//! What came of a check the last time: a file of `docs/reliability`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use time::OffsetDateTime;

/// What came of a check.
pub(crate) enum Verdict<'a> {
    Fine,
    Failed(&'a str),
    Skipped(&'a str),
}

/// A check's file.
#[derive(Serialize, Deserialize)]
pub(super) struct Record {
    /// How much was checked, in words.
    pub(super) count: String,
    pub(super) result: Word,
    /// Why, if it isn't fine.
    pub(super) why: String,
    /// UTC, as 2026-01-31.
    pub(super) date: String,
    /// The commit that was checked; with a `+`, changed.
    pub(super) version: String,
    pub(super) machine: String,
    /// What the page shows of it in tables of its own.
    #[serde(default, skip_serializing_if = "Value::is_null")]
    pub(super) found: Value,
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Word {
    Fine,
    Failed,
    Skipped,
}

/// Keeps what came of a check: how much was checked, in words, and the result.
pub(crate) fn keep(check: &str, count: &str, verdict: &Verdict<'_>) -> Result<()> {
    keep_found(check, count, verdict, Value::Null)
}

/// The same with what was found out in full. A check that can't be done here leaves what was found out elsewhere.
pub(crate) fn keep_found(check: &str, count: &str, verdict: &Verdict<'_>, found: Value) -> Result<()> {
    let path = path(&folder(), check);
    let (result, why) = match verdict {
        Verdict::Skipped(_) if path.is_file() => return Ok(()),
        Verdict::Skipped(why) => (Word::Skipped, *why),
        Verdict::Failed(why) => (Word::Failed, *why),
        Verdict::Fine => (Word::Fine, ""),
    };
    let (count, why) = (count.to_owned(), why.to_owned());
    let record = Record { count, result, why, date: today(), version: version(), machine: machine(), found };
    std::fs::create_dir_all(folder()).with_context(|| folder().display().to_string())?;
    let text = serde_json::to_string(&record)? + "\n";
    std::fs::write(&path, text).with_context(|| path.display().to_string())
}

/// What a check found out in full the last time, if it was run.
pub(crate) fn found(check: &str) -> Result<Option<Value>> {
    Ok(read(&folder(), check)?.map(|record| record.found))
}

/// A check's record, if it was run.
pub(super) fn read(folder: &Path, check: &str) -> Result<Option<Record>> {
    let path = path(folder, check);
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(Some(serde_json::from_str(&text).with_context(|| path.display().to_string())?)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(e).with_context(|| path.display().to_string()),
    }
}

/// Where records are kept.
pub(super) fn folder() -> PathBuf {
    crate::root().join("docs/reliability")
}

fn path(folder: &Path, check: &str) -> PathBuf {
    folder.join(format!("{check}.json"))
}

/// The commit that is checked out, with a `+` if more than docs was changed since; else the package's version.
fn version() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(crate::root()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "--short=7", "HEAD"]) else {
        return env!("CARGO_PKG_VERSION").to_owned();
    };
    let is_changed = git(&["status", "--porcelain", "--", ".", ":!docs"]).is_none_or(|files| !files.is_empty());
    if is_changed { format!("{commit}+") } else { commit }
}

/// The date, UTC, as 2026-01-31.
fn today() -> String {
    date(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_secs()))
}

/// Of seconds since 1970; nothing beyond the year 9999.
fn date(secs: u64) -> String {
    let time = i64::try_from(secs).ok().and_then(|secs| OffsetDateTime::from_unix_timestamp(secs).ok());
    time.map_or_else(String::new, |time| time.date().to_string())
}

/// What the processor calls itself, where that can be found out.
fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |name| name.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        assert_eq!(date(0), "1970-01-01");
        assert_eq!(date(19_782 * 86_400), "2024-02-29");
        assert_eq!(date(20_786 * 86_400), "2026-11-29");
        assert_eq!(date(11_016 * 86_400), "2000-02-29");
    }
}
