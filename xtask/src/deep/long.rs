//! What takes hours: altered files, fuzzing, and a billion rays. Tasks of their own, which are run here as from the command line.

use std::ffi::OsString;

use anyhow::Result;
use clap::Parser;

use super::{Arguments, Outcome};
use crate::{fuzz, reliability, soak};

/// A million altered saved trees, and a million more that are signed anew.
pub(super) fn mutants(arguments: &Arguments) -> Result<Outcome> {
    reliability::test("mutants", &arguments.profile).map(Outcome::Told)
}

pub(super) fn fuzz(_: &Arguments) -> Result<Outcome> {
    if !fuzz::is_possible() {
        return Ok(Outcome::Skipped("it takes nightly Rust and cargo-fuzz".into()));
    }
    fuzz::run(&fuzz::Arguments::parse_from(["fuzz", "--secs", "600"])).map(Outcome::Told)
}

pub(super) fn soak(arguments: &Arguments) -> Result<Outcome> {
    let mut words: Vec<OsString> =
        ["soak", "--rays", "1e9", "--profile", &arguments.profile].map(OsString::from).into();
    words.extend(arguments.scenes.iter().flat_map(|folder| ["--scenes".into(), folder.into()]));
    soak::run(&soak::Arguments::parse_from(words)).map(Outcome::Told)
}
