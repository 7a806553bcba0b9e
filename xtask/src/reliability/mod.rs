//! `cargo xtask reliability`: what is promised, how it is tested, and what came of it the last time, as a page of docs.
//!
//! Every check keeps its record in `docs/reliability`, a file each; the page is made from these alone, so it says nothing that was not
//! found out. They are committed with it: what took hours stands, with its date and version, beside what was run since. A check that
//! wasn't run says so.

mod page;
mod promises;
mod record;

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};

pub(crate) use page::grouped;
use promises::TESTS;
pub(crate) use record::{Verdict, found, keep, keep_found};

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
    let page = page::Page::of(&record::folder())?;
    let path = crate::root().join(&arguments.output);
    std::fs::write(&path, page.text()).with_context(|| path.display().to_string())?;
    Ok(page.is_clean())
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
    let count = tests(passed);
    if output.status.success() {
        ensure!(passed > 0, "{}: no test has this name", test.name);
        return keep(test.name, &count, &Verdict::Fine).map(|()| true);
    }
    eprintln!("{text}{}", String::from_utf8_lossy(&output.stderr));
    keep(test.name, &count, &Verdict::Failed("a test failed")).map(|()| false)
}

/// So many, in words.
pub(crate) fn tests(count: u64) -> String {
    if count == 1 { "1 test".to_owned() } else { format!("{count} tests") }
}

/// Of `test result: ok. 12 passed; …`.
pub(crate) fn passed(line: &str) -> Option<u64> {
    line.strip_prefix("test result: ")?.split_whitespace().nth(1)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passed_tests_are_counted() {
        assert_eq!(passed("test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured"), Some(12));
        assert_eq!(passed("running 12 tests"), None);
    }
}
