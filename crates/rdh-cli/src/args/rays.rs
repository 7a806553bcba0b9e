//! Arguments of `rdh rays`.

use std::path::PathBuf;

use super::values;

/// Say what profiles hold and how far they are apart; merge, thin or split them.
///
/// Several files can be merged and thinned at once. Profiles that are merged must have been recorded with the same seed.
#[derive(Debug, clap::Args)]
pub(crate) struct RaysArgs {
    /// Profiles
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Join all files: the same as if one recorder had seen all rays
    #[arg(long, requires = "output")]
    pub merge: bool,
    /// Keep at most N samples, the same as if the recorder had been so small
    #[arg(long, value_name = "N", value_parser = values::ray_count, requires = "output")]
    pub thin: Option<usize>,
    /// Split into three files that share no ray, by --seed: OUT.training.rays, OUT.held-out.rays, OUT.unseen.rays
    #[arg(long, requires = "output")]
    pub split: bool,
    /// Say how far each file's rays are from this profile's, or from those that a saved tree was made for: whether it is time
    /// to tune again
    #[arg(long, value_name = "F.rays|TREE", conflicts_with_all = ["merge", "thin", "split"])]
    pub drift: Option<PathBuf>,
    /// The profile to write
    #[arg(short, long, value_name = "OUT.rays")]
    pub output: Option<PathBuf>,
}
