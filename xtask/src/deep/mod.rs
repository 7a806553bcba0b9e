//! `cargo xtask deep`: checks that take too long for the ordinary tests. Each says that it is fine, that it has failed, or why it
//! can't be done here.

mod arm;
mod audit;
mod identical;

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

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
    Fine,
    Failed(String),
    /// It can't be done here, for a reason.
    Skipped(String),
}

/// A name, and what it runs.
type Check = (&'static str, fn(&Arguments) -> Result<Outcome>);

const CHECKS: [Check; 3] = [("identical", identical::run), ("audit", audit::run), ("arm", arm::run)];

/// Whether none has failed.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let known = |name: &String| CHECKS.iter().any(|check| check.0 == name);
    if let Some(name) = arguments.check.iter().find(|name| !known(name)) {
        bail!("there is no check {name}; known: {}", CHECKS.map(|check| check.0).join(", "));
    }
    let wanted = |check: &&Check| arguments.check.is_empty() || arguments.check.iter().any(|name| name == check.0);
    let mut fine = true;
    for (name, run) in CHECKS.iter().filter(wanted) {
        match run(arguments).with_context(|| (*name).to_owned())? {
            Outcome::Fine => println!("{name}: ok"),
            Outcome::Skipped(why) => println!("{name}: skipped: {why}"),
            Outcome::Failed(what) => {
                println!("{name}: failed: {what}");
                fine = false;
            }
        }
    }
    Ok(fine)
}

/// The folder of the workspace.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// An example of the study over the embedded scenes and those of the folder.
fn example(name: &str, arguments: &Arguments) -> Command {
    let mut command = Command::new("cargo");
    command.args(["run", "--release", "--quiet", "-p", "rdh-study", "--example", name, "--"]);
    if let Some(folder) = arguments.scenes(name) {
        command.arg("--scenes").arg(folder);
    }
    command
}

/// Runs a command in the folder of the workspace; what it says goes to this program's own output.
fn outcome(command: &mut Command) -> Result<Outcome> {
    let name = command.get_program().display().to_string();
    let status = command.current_dir(root()).status().with_context(|| name.clone())?;
    Ok(if status.success() { Outcome::Fine } else { Outcome::Failed(format!("{name}: {status}")) })
}
