//! Developer tasks: `cargo xtask TASK`.

mod engines;

use std::process::ExitCode;

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
    /// Get and build the competitors that `rdh bench` races (engines/README.md).
    Engines(engines::Arguments),
}

fn main() -> ExitCode {
    let Arguments { task: Task::Engines(arguments) } = Arguments::parse();
    match engines::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
