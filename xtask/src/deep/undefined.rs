//! Undefined behaviour: Miri over the modules with `unsafe` and over small builds, AddressSanitizer over all of the library's own tests.

use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, says, tests};

/// What Miri runs: all of `mem`, saved arrays, and small trees built and traced by portable code; it knows no vector instructions.
const MIRI: [&str; 2] = ["mem::", "build::tests::small"];

/// The one target whose sanitizer comes with Rust and is asked for here.
const TARGET: &str = "x86_64-unknown-linux-gnu";

pub(super) fn miri(_: &Arguments) -> Result<Outcome> {
    if !says(Command::new("cargo").args(["+nightly", "miri", "--version"])) {
        return Ok(Outcome::Skipped("there is no Miri: rustup +nightly component add miri rust-src".into()));
    }
    let mut command = nightly(&["miri", "test", "-p", "rdh", "--lib"]);
    // Rayon's queues are not ours to judge, and its threads have no end that Miri would wait for.
    command.env("MIRIFLAGS", "-Zmiri-disable-isolation -Zmiri-ignore-leaks -Zmiri-tree-borrows");
    command.arg("--").args(MIRI);
    tests(&mut command)
}

pub(super) fn asan(_: &Arguments) -> Result<Outcome> {
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) || !says(&mut nightly(&["--version"])) {
        return Ok(Outcome::Skipped(format!("it takes nightly Rust on {TARGET}")));
    }
    let mut command = nightly(&["test", "--release", "-p", "rdh", "--lib", "--target", TARGET]);
    command.env("RUSTFLAGS", "-Zsanitizer=address -Cdebug-assertions");
    tests(&mut command)
}

/// Cargo of nightly Rust, in a folder of its own: other flags would build everything anew.
fn nightly(arguments: &[&str]) -> Command {
    let mut command = Command::new("cargo");
    command.arg("+nightly").args(arguments).env_remove("RUSTUP_TOOLCHAIN");
    if let Ok(target) = crate::target() {
        command.env("CARGO_TARGET_DIR", target.join("nightly"));
    }
    command
}
