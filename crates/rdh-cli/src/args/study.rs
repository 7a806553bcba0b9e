//! Arguments of `rdh study` and `rdh merge`.

use std::path::PathBuf;

use rdh_study::Mode;
use rdh_study::study::Shard;

use super::values::{self, Size};

/// Answer the questions of the study: what knowing the rays gains, where, and where not.
///
/// Works through all experiments, job by job; each job is safe in the folder's log before the next begins, so that a run can be killed at
/// any moment and resumed. Prints the summary at the end; `rdh report` makes a page of it.
#[derive(Debug, clap::Args)]
pub(crate) struct StudyArgs {
    /// Scenes by id [default: all embedded ones, and all of --scenes DIR]
    #[arg(value_name = "SCENE")]
    pub names: Vec<String>,
    /// Which questions, with commas between them [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub experiment: Vec<String>,
    /// Which rays, with commas: primary, whitted, path, ao, lidar [default: all that the experiments ask for]
    #[arg(long, value_name = "MODE", value_delimiter = ',')]
    pub mode: Vec<Mode>,
    /// A first look: small scenes, few views, few rays
    #[arg(long)]
    pub quick: bool,
    /// The study's folder: its plan and its logs
    #[arg(long, value_name = "DIR", default_value = "study")]
    pub out: PathBuf,
    /// Go on with what is in the folder
    #[arg(long)]
    pub resume: bool,
    /// Do one part of N only; `rdh merge` joins them
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    pub shard: Shard,
    /// Width and height of the film: one test ray a pixel [default: 256x256; quick: 128x128]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// How many training rays a view gets [default: 16384; quick: 4096]
    #[arg(long, value_name = "N", value_parser = values::ray_count)]
    pub training: Option<usize>,
    /// How often all rays are cast, for timing [default: 4]
    #[arg(long, value_name = "N", value_parser = values::rounds)]
    pub rounds: Option<usize>,
}

/// Join the parts of a study, check that nothing is missing, and print its summary.
///
/// Exit code 3 if jobs are missing, or if structures or repeated jobs disagree.
#[derive(Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// Folders of `rdh study --out`
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// Write the joined study into a folder of its own
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Leave out all that a clock said: equal studies then print equal text
    #[arg(long, requires = "json")]
    pub counts_only: bool,
}
