//! Arguments of `rdh verify`.

use std::path::PathBuf;

use super::values;

/// Prove a saved tree: well-formed, right, and not slower than one built by areas.
///
/// Every node and triangle is checked, and the answers to aimed rays are compared with brute force, bit for bit. Where the
/// tree has unseen rays (or with --rays), a structure is built by areas, and both cast them in turn. Exit code 3 if
/// anything is wrong.
#[derive(Debug, clap::Args)]
pub(crate) struct VerifyArgs {
    /// A saved tree
    #[arg(value_name = "TREE")]
    pub tree: PathBuf,
    /// A profile to judge by: the quarter that `rdh build` with the same --seed has not seen. How far its rays have drifted
    /// from those that the tree was made for is said, too
    #[arg(long, value_name = "F.rays")]
    pub rays: Option<PathBuf>,
    /// How many rays are compared with brute force [default: as many as take seconds, 64 to 4096]
    #[arg(long, value_name = "N", value_parser = values::ray_count)]
    pub samples: Option<usize>,
    /// What the tree must not be slower than [default: for a tuned tree the best one by areas that was tried; else its
    /// own structure with sah]
    #[arg(long, value_name = "SPECS")]
    pub base: Option<String>,
    /// How often the rays are cast through each
    #[arg(long, value_name = "N", value_parser = values::rounds, default_value_t = 9)]
    pub rounds: usize,
    /// Judge by steps and tests instead of time: repeatable
    #[arg(long)]
    pub counts_only: bool,
    /// Slower by no more than this part is not slower: where arrays lie in memory makes such differences
    #[arg(long, value_name = "PART", value_parser = values::part, default_value_t = 0.02)]
    pub margin: f64,
}
