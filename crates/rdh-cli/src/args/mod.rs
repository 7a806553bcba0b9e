//! What was typed.

mod bench;
mod build;
mod cast;
mod compare;
mod convert;
mod rays;
mod record;
mod render;
mod report;
mod scenes;
mod shell;
mod study;
mod tune;
mod values;
mod verify;

use std::path::PathBuf;

use clap::{ArgAction, ColorChoice, Parser, Subcommand};

pub(crate) use bench::BenchArgs;
pub(crate) use build::BuildArgs;
pub(crate) use cast::{CastArgs, Rows};
pub(crate) use compare::CompareArgs;
pub(crate) use convert::ConvertArgs;
pub(crate) use rays::RaysArgs;
pub(crate) use record::RecordArgs;
pub(crate) use render::{Heat, RenderArgs};
pub(crate) use report::ReportArgs;
pub(crate) use scenes::ScenesArgs;
pub(crate) use shell::{CompletionsArgs, ManArgs};
pub(crate) use study::{MergeArgs, StudyArgs};
pub(crate) use tune::TuneArgs;
pub(crate) use values::{Place, Size, Slice};
pub(crate) use verify::VerifyArgs;

/// rdh: profile-guided ray tracing.
///
/// Builds acceleration structures by the surface area heuristic (SAH) and by the ray distribution heuristic (RDH), which
/// knows a sample of the rays that are really cast, and says what the difference is.
#[derive(Debug, Parser)]
#[command(name = "rdh", version, arg_required_else_help = true, max_term_width = 110, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 fine, 1 failed, 2 usage, 3 a verification failed.";

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Build with several specs, cast the same rays, and print what they cost
    Compare(CompareArgs),
    /// Answer the study's questions over many scenes; can be killed, resumed and shared out
    Study(StudyArgs),
    /// Join the parts of a study, check them, and print its summary
    Merge(MergeArgs),
    /// List scenes and their views, or say what is in mesh files
    Scenes(ScenesArgs),
    /// Record the rays of a mode as a profile
    Record(RecordArgs),
    /// Say what profiles hold and how far they are apart; merge, thin or split them
    Rays(RaysArgs),
    /// Build a structure and save it
    Build(BuildArgs),
    /// Prove a saved tree: well-formed, right, not slower than one built by areas
    Verify(VerifyArgs),
    /// Cast the rays of a NumPy file
    Cast(CastArgs),
    /// Convert between files of meshes, and between files of rays
    Convert(ConvertArgs),
    /// Choose structure and heuristic by rays that are really cast
    Tune(TuneArgs),
    /// Draw a picture: shaded, a heat map of costs, or a slice through the cells
    Render(RenderArgs),
    /// Make one self-contained page of a study
    Report(ReportArgs),
    /// Race our structures against other libraries'
    Bench(BenchArgs),
    /// Print what a shell needs to complete arguments
    Completions(CompletionsArgs),
    /// Print the manual page, or write those of all commands
    Man(ManArgs),
}

/// Arguments that every command takes.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Everywhere")]
pub(crate) struct Global {
    /// Print JSON on standard output, and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// A folder with a scenes.toml: further scenes
    #[arg(long, global = true, value_name = "DIR")]
    pub scenes: Option<PathBuf>,
    /// How many threads work (times are always those of one) [default: one a core]
    #[arg(long, global = true, value_name = "N", value_parser = values::threads)]
    pub threads: Option<usize>,
    /// What all randomness comes from: the same seed gives the same counts
    #[arg(long, global = true, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Say more on standard error; twice for details
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub verbose: u8,
    /// Say only errors
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Whether to colour
    #[arg(long, global = true, value_name = "WHEN", value_enum, default_value_t = ColorChoice::Auto)]
    pub color: ColorChoice,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Cli::command().debug_assert();
    }
}
