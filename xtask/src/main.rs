//! Developer tasks: `cargo xtask TASK`.

mod browser;
mod deep;
mod engines;
mod fuzz;
mod reliability;
mod soak;
mod study;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

/// Developer tasks for rdh.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Look at a page in a real browser, and complain.
    Browser(browser::Arguments),
    /// Run checks that take too long for the ordinary tests.
    Deep(deep::Arguments),
    /// Get and build the competitors that `rdh bench` races (engines/README.md).
    Engines(engines::Arguments),
    /// Fuzz everything that reads or builds (fuzz/): needs nightly Rust and cargo-fuzz.
    Fuzz(fuzz::Arguments),
    /// Write docs/reliability.md from what checks have found out.
    Reliability(reliability::Arguments),
    /// Cast rays from inside closed meshes, a billion of them if need be: none may escape.
    Soak(soak::Arguments),
    /// Run a study in parts side by side, and put its page and tables into docs/study.
    Study(study::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().task {
        Task::Browser(arguments) => browser::run(&arguments),
        Task::Deep(arguments) => deep::run(&arguments),
        Task::Engines(arguments) => engines::run(&arguments).map(|()| true),
        Task::Fuzz(arguments) => fuzz::run(&arguments),
        Task::Reliability(arguments) => reliability::run(&arguments),
        Task::Soak(arguments) => soak::run(&arguments),
        Task::Study(arguments) => study::run(&arguments).map(|()| true),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(3),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the workspace.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Cargo's target folder: that of this program, two levels up.
fn target() -> Result<PathBuf> {
    let program = std::env::current_exe()?;
    Ok(program.parent().and_then(Path::parent).context("this program has no place")?.to_owned())
}
