//! What others wrote and we build in: licences, where it comes from, and which versions (`deny.toml`).

use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, outcome, says};

pub(super) fn run(_: &Arguments) -> Result<Outcome> {
    if !says(Command::new("cargo").args(["deny", "--version"])) {
        return Ok(Outcome::Skipped("there is no cargo-deny: cargo install cargo-deny".into()));
    }
    let found = outcome(Command::new("cargo").args(["deny", "check", "licenses", "bans", "sources"]), None)?;
    Ok(match found {
        Outcome::Fine(_) => Outcome::Fine("licences, bans, sources".into()),
        other => other,
    })
}
