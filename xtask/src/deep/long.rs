//! What takes hours: altered files, fuzzing, and a billion rays.

use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, outcome};
use crate::{fuzz, soak};

/// Seconds that a fuzz target gets.
const FUZZ_SECS: u64 = 600;
/// Rays from inside closed meshes.
const RAYS: &str = "1e9";

/// A million altered saved trees, and a million more that are signed anew.
pub(super) fn mutants(arguments: &Arguments) -> Result<Outcome> {
    let mut command = Command::new("cargo");
    command.args(["test", "--profile", &arguments.profile, "-p", "rdh", "--test", "saved", "--", "--ignored"]);
    outcome(command.arg("a_million_altered_files"), &["test result: ok."])
}

pub(super) fn fuzz(_: &Arguments) -> Result<Outcome> {
    if !fuzz::is_possible() {
        return Ok(Outcome::Skipped("it takes nightly Rust and cargo-fuzz".into()));
    }
    fuzz::run(&fuzz::Arguments::all_for(FUZZ_SECS)).map(Outcome::Told)
}

pub(super) fn soak(arguments: &Arguments) -> Result<Outcome> {
    soak::run(&soak::Arguments::of(RAYS, arguments.scenes("soak"), &arguments.profile)).map(Outcome::Told)
}
