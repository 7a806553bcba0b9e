//! `cargo xtask deep`: checks that take too long for the ordinary tests. Each says that it is fine, that it has failed, or why it
//! can't be done here.

mod arm;
mod bounds;
mod identical;
mod targets;
mod undefined;

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::reliability::{Verdict, keep};
use crate::root;

/// Run checks that take too long for the ordinary tests.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Checks by name; without any, all
    check: Vec<String>,
    /// A folder of scenes with a scenes.toml [default: ../shared/scenes, if it is there]
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
}

/// What becomes of a check.
enum Outcome {
    /// How much was checked, in words.
    Fine(String),
    Failed(String),
    /// It can't be done here, for a reason.
    Skipped(String),
}

/// A name, and what it runs.
type Check = (&'static str, fn(&Arguments) -> Result<Outcome>);

const CHECKS: [Check; 6] = [
    ("identical", identical::run),
    ("arm", arm::run),
    ("cancel", bounds::run),
    ("miri", undefined::miri),
    ("asan", undefined::asan),
    ("targets", targets::run),
];

/// Whether none has failed.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let known = |name: &String| CHECKS.iter().any(|check| check.0 == name);
    if let Some(name) = arguments.check.iter().find(|name| !known(name)) {
        bail!("there is no check {name}; known: {}", CHECKS.map(|check| check.0).join(", "));
    }
    let wanted = |check: &&Check| arguments.check.is_empty() || arguments.check.iter().any(|name| name == check.0);
    let mut fine = true;
    for (name, run) in CHECKS.iter().filter(wanted) {
        let verdict = match run(arguments).with_context(|| (*name).to_owned())? {
            Outcome::Fine(count) => {
                println!("{name}: ok: {count}");
                keep(name, &count, &Verdict::Fine)
            }
            Outcome::Skipped(why) => {
                println!("{name}: skipped: {why}");
                keep(name, "", &Verdict::Skipped(&why))
            }
            Outcome::Failed(what) => {
                println!("{name}: failed: {what}");
                fine = false;
                keep(name, "", &Verdict::Failed(&what))
            }
        };
        verdict?;
    }
    Ok(fine)
}

/// Runs a command in the folder of the workspace, and shows what it says. The last line that begins with one of the `words` says how
/// much was checked.
fn outcome(command: &mut Command, words: &[&str]) -> Result<Outcome> {
    let name = command.get_program().display().to_string();
    let mut child = command.current_dir(root()).stdout(Stdio::piped()).spawn().with_context(|| name.clone())?;
    let mut counts = Vec::new();
    for line in BufReader::new(child.stdout.take().context("it has no output")?).lines() {
        let line = line?;
        println!("{line}");
        if let Some(word) = words.iter().find(|word| line.starts_with(**word)) {
            counts.push(line[word.len()..].trim().to_owned());
        }
    }
    let status = child.wait()?;
    let count = counts.pop().unwrap_or_default();
    Ok(if status.success() { Outcome::Fine(count) } else { Outcome::Failed(format!("{name}: {status}")) })
}

/// Whether a program can be run.
fn says(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
