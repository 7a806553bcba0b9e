//! All kinds of trees, built in all ways for all scenes, and their answers at every level, compared in every bit.

use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, outcome};
use crate::root;

pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let beside = root().join("../shared/scenes");
    let scenes = arguments.scenes.clone().or_else(|| beside.join("scenes.toml").is_file().then_some(beside));
    let mut command = Command::new("cargo");
    command.args(["run", "--release", "--quiet", "-p", "rdh-study", "--example", "identical", "--"]);
    match &scenes {
        Some(folder) => command.arg("--scenes").arg(folder),
        None => {
            eprintln!("identical: there are no ../shared/scenes: the embedded scenes alone");
            &mut command
        }
    };
    outcome(&mut command, &["in all:"])
}
