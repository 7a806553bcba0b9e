//! Arguments of `rdh tune`.

use std::path::PathBuf;

use rdh_study::Mode;

use super::values::{self, ClassWeights, Size};

/// Choose structure and heuristic by rays that are really cast, never worse than without them.
///
/// Rays are recorded (or read), and split: candidates are built from half of them, raced on a quarter, first by steps and tests,
/// then by time, and the winner is compared with the best structure that needs no rays on the last quarter. It is taken only if it is
/// surely faster. If a choice turns out surely slower on the last quarter, that is exit code 3.
#[derive(Debug, clap::Args)]
pub(crate) struct TuneArgs {
    /// Scenes by id (balls4), views of them (balls4:front), or mesh files; each view and mode is a case of its own
    /// [default: the quick set; all scenes of --scenes DIR if that is given]
    #[arg(value_name = "SCENE")]
    pub names: Vec<String>,
    /// Which rays, more than one with commas: primary, whitted, path, ao, lidar
    #[arg(long, value_name = "MODE", value_delimiter = ',', default_value = "primary")]
    pub mode: Vec<Mode>,
    /// Rays that were recorded, instead of a mode's; for one scene
    #[arg(long, value_name = "F.rays", conflicts_with_all = ["mode", "size", "capacity"])]
    pub rays: Option<PathBuf>,
    /// Decide by steps and tests alone: the same choice on every machine and at every time
    #[arg(long)]
    pub counts_only: bool,
    /// What to try: specs with commas between them, one of which needs no rays [default: --list]
    #[arg(long, value_name = "LIST")]
    pub candidates: Option<String>,
    /// Print what is tried by default, and why
    #[arg(long, conflicts_with_all = ["names", "mode", "rays", "candidates", "output"])]
    pub list: bool,
    /// What a ray of a class counts, such as shadow=2,primary=0 [default: 1 each]
    #[arg(long, value_name = "CLASS=N,…", default_value = "")]
    pub weights: ClassWeights,
    /// At most so many megabytes for a structure
    #[arg(long, value_name = "MB", value_parser = values::megabytes)]
    pub max_mb: Option<usize>,
    /// At most so many seconds for a build
    #[arg(long, value_name = "S", conflicts_with = "counts_only")]
    pub max_build_secs: Option<f64>,
    /// How often the last ones are timed
    #[arg(long, value_name = "N", value_parser = values::rounds, default_value_t = 15)]
    pub rounds: usize,
    /// How many distinct rays are recorded at most
    #[arg(long, value_name = "N", value_parser = values::ray_count, default_value_t = 65_536)]
    pub capacity: usize,
    /// Width and height of the film: one path a pixel
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    pub size: Size,
    /// The structure to write, with the evidence; for one mode of one view (the scene's first one unless it is named)
    #[arg(short, long, value_name = "F.rdh")]
    pub output: Option<PathBuf>,
}
