//! `cargo xtask deep`: checks that take too long for the ordinary tests. Each says that it is fine, that it has failed, or why it
//! can't be done here.

mod arm;
mod audit;
mod bounds;
mod identical;
mod long;
mod supply;
mod targets;
mod undefined;

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::reliability::{self, Verdict, keep};
use crate::root;

/// Run checks that take too long for the ordinary tests.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Checks by name; without any, all
    check: Vec<String>,
    /// A folder of scenes with a scenes.toml [default: ../shared/scenes, if it is there]
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
    /// Let the clock decide in `audit`, too: on a machine that is idle
    #[arg(long)]
    times: bool,
    /// Cargo's profile
    #[arg(long, default_value = "release")]
    profile: String,
}

impl Arguments {
    /// The folder of scenes, if there is one; else it is said that `check` does without.
    fn scenes(&self, check: &str) -> Option<PathBuf> {
        let beside = root().join("../shared/scenes");
        let scenes = self.scenes.clone().or_else(|| beside.join("scenes.toml").is_file().then_some(beside));
        if scenes.is_none() {
            eprintln!("{check}: there are no ../shared/scenes: the embedded scenes alone");
        }
        scenes
    }
}

/// What becomes of a check.
enum Outcome {
    /// How much was checked, in words.
    Fine(String),
    Failed(String),
    /// It can't be done here, for a reason.
    Skipped(String),
    /// A task of its own, which has said and kept what it found: whether all was fine.
    Told(bool),
}

/// A name, and what it runs.
type Check = (&'static str, fn(&Arguments) -> Result<Outcome>);

const CHECKS: [Check; 11] = [
    ("identical", identical::run),
    ("audit", audit::run),
    ("arm", arm::run),
    ("cancel", bounds::run),
    ("miri", undefined::miri),
    ("asan", undefined::asan),
    ("targets", targets::run),
    ("deny", supply::run),
    ("mutants", long::mutants),
    ("fuzz", long::fuzz),
    ("soak", long::soak),
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
            Outcome::Told(is_fine) => {
                println!("{name}: {}", if is_fine { "ok" } else { "failed" });
                fine &= is_fine;
                Ok(())
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

/// Runs a command in the folder of the workspace, and shows what it says. The last line that begins with `word` says how much was
/// checked.
fn outcome(command: &mut Command, word: Option<&str>) -> Result<Outcome> {
    let mut count = String::new();
    let failed = run_and_see(command, &mut |line| {
        if let Some(rest) = word.and_then(|word| line.strip_prefix(word)) {
            rest.trim().clone_into(&mut count);
        }
    })?;
    Ok(failed.map_or(Outcome::Fine(count), Outcome::Failed))
}

/// The same for tests: how many have passed.
fn tests(command: &mut Command) -> Result<Outcome> {
    let mut passed = 0;
    let failed = run_and_see(command, &mut |line| passed += reliability::passed(line).unwrap_or(0))?;
    Ok(match failed {
        Some(why) => Outcome::Failed(why),
        None if passed == 0 => Outcome::Failed("no test has run".to_owned()),
        None => Outcome::Fine(reliability::tests(passed)),
    })
}

/// Runs a command, shows what it says, and hands it over line by line; why it has failed, if it has.
fn run_and_see(command: &mut Command, see: &mut dyn FnMut(&str)) -> Result<Option<String>> {
    let name = command.get_program().display().to_string();
    let mut child = command.current_dir(root()).stdout(Stdio::piped()).spawn().with_context(|| name.clone())?;
    for line in BufReader::new(child.stdout.take().context("it has no output")?).lines() {
        let line = line?;
        println!("{line}");
        see(&line);
    }
    let status = child.wait()?;
    Ok((!status.success()).then(|| format!("{name}: {status}")))
}

/// An example of the study over the embedded scenes and those of the folder.
fn example(name: &str, arguments: &Arguments) -> Command {
    let mut command = Command::new("cargo");
    command.args(["run", "--profile", &arguments.profile, "--quiet", "-p", "rdh-study", "--example", name, "--"]);
    if let Some(folder) = arguments.scenes(name) {
        command.arg("--scenes").arg(folder);
    }
    command
}

/// Whether a program can be run.
fn says(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
