//! The program `rdh`: what was typed ([`args`]) -> what is meant -> the crates ([`commands`]).

mod args;
mod commands;
mod context;
mod exit;
mod machine;
mod npy;
mod output;
mod pick;
mod picture;
mod staged;
mod summary;
mod table;

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;

use args::{Cli, Command};
use context::Context;

fn main() -> ExitCode {
    exit::code(run(&Cli::parse()))
}

fn run(cli: &Cli) -> Result<()> {
    let context = Context::new(&cli.global)?;
    match &cli.command {
        Command::Compare(args) => commands::compare::run(args, &context),
        Command::Study(args) => commands::study::run(args, &context),
        Command::Merge(args) => commands::merge::run(args, &context),
        Command::Scenes(args) => commands::scenes::run(args, &context),
        Command::Record(args) => commands::record::run(args, &context),
        Command::Rays(args) => commands::rays::run(args, &context),
        Command::Build(args) => commands::build::run(args, &context),
        Command::Verify(args) => commands::verify::run(args, &context),
        Command::Cast(args) => commands::cast::run(args, &context),
        Command::Convert(args) => commands::convert::run(args, &context),
        Command::Tune(args) => commands::tune::run(args, &context),
        Command::Render(args) => commands::render::run(args, &context),
        Command::Report(args) => commands::report::run(args, &context),
        Command::Bench(args) => commands::bench::run(args, &context),
        Command::Completions(args) => commands::shell::completions(args),
        Command::Man(args) => commands::shell::man(args),
    }
}
