//! Whether everything compiles for other systems, as far as this one has their standard library.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, outcome};

const TARGETS: [&str; 4] =
    ["aarch64-unknown-linux-gnu", "x86_64-pc-windows-msvc", "aarch64-apple-darwin", "i686-unknown-linux-gnu"];

pub(super) fn run(_: &Arguments) -> Result<Outcome> {
    let (here, missing): (Vec<&str>, Vec<&str>) = TARGETS.into_iter().partition(|target| has_library(target));
    if here.is_empty() {
        return Ok(Outcome::Skipped(format!("the standard library is here for none of {}", missing.join(", "))));
    }
    for target in &here {
        let mut command = Command::new("cargo");
        let checked = outcome(command.args(["check", "-p", "rdh", "--target", target]), None)?;
        if let Outcome::Failed(why) = checked {
            return Ok(Outcome::Failed(format!("{target}: {why}")));
        }
    }
    let without = if missing.is_empty() { String::new() } else { format!("; not here: {}", missing.join(", ")) };
    Ok(Outcome::Fine(format!("{}{without}", here.join(", "))))
}

fn has_library(target: &str) -> bool {
    let folder = Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
    folder.is_ok_and(|out| out.status.success() && Path::new(String::from_utf8_lossy(&out.stdout).trim()).is_dir())
}
