//! How long builders work between two questions whether to stop.

use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, outcome};

pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let mut command = Command::new("cargo");
    command.args(["run", "--profile", &arguments.profile, "--quiet", "-p", "rdh-study", "--example", "cancel"]);
    outcome(&mut command, Some("in all:"))
}
