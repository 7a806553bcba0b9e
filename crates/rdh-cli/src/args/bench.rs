//! Arguments of `rdh bench`.

use std::path::PathBuf;

use rdh::simd::Level;
use rdh_study::bench::{BenchPlan, Column};

use super::values;

/// Our structures and other libraries', side by side: the same rays, answers compared before times, one thread.
///
/// Competitors are programs of their own: `cargo xtask engines --fetch` gets and builds them. Those that aren't there are
/// skipped by name. Wrong answers are exit code 3, and their times don't count.
#[derive(Debug, clap::Args)]
pub(crate) struct BenchArgs {
    /// Scenes by id or file, perhaps with a view; of each, the first view races
    /// [default: all of --scenes DIR, and generated ones: building, city, forest, terrain-large (1.6 to 2.0 million triangles)]
    #[arg(value_name = "SCENE")]
    pub names: Vec<String>,
    /// A small race: 512x512 primary rays, 2 rounds, scenes of files up to 300,000 triangles, and generated ones of
    /// about 100,000 (rooms, quarter, grove, terrain)
    #[arg(long)]
    pub quick: bool,
    /// Measure builds instead, ours alone: CPU time of one thread, elapsed time on one and on two, growth
    /// [default scenes: those of --scenes DIR, terrains of 0.1, 1 and 5 million triangles, rooms, city]
    #[arg(long, conflicts_with_all = ["quick", "engines", "columns", "size", "out", "engine_dir", "memory", "levels"])]
    pub builds: bool,
    /// Our structures [default: bvh8(high)+sah,bvh8+sah,kd+sah]; those that need rays are trained on others of the columns
    #[arg(long, visible_alias = "spec", value_name = "LIST")]
    pub specs: Option<String>,
    /// Trace ours with these instructions, each beside the others: portable, avx2, avx512, neon, as far as this CPU has them
    /// [default: its best]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = values::level)]
    pub levels: Vec<Level>,
    /// Race the first bvh8 or sbvh8 of ours against leaky twins of itself, too: what watertightness costs, in boxes and triangles
    #[arg(long)]
    pub twin: bool,
    /// Competitors, with commas: embree4, embree4-robust, embree4-pkt16, embree3, obvhs, …; none: ours alone [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub engines: Option<Vec<String>>,
    /// Kinds of rays, with commas: rows, tiles, shadow, bounce, ao, shuffled [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub columns: Option<Vec<Column>>,
    /// Width and height of the film, one primary ray a pixel [default: 1024; with --quick 512]
    #[arg(long, value_name = "N|NxN", value_parser = square)]
    pub size: Option<usize>,
    /// How often each casts all rays [default: 3; with --quick 2]
    #[arg(long, value_name = "N", value_parser = values::rounds)]
    pub rounds: Option<usize>,
    /// How many of our hits others may answer differently, in per cent, before their times don't count
    #[arg(long, value_name = "PERCENT", default_value_t = 0.1)]
    pub tolerance: f64,
    /// Append what is found out to this file as it comes, and take from it what is there already
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// The folder of the competitors' programs [default: engines/bin beside the folder of this program]
    #[arg(long, value_name = "DIR")]
    pub engine_dir: Option<PathBuf>,
    /// How much memory competitors may use together, in GiB [default: seven tenths of what is free]
    #[arg(long, value_name = "GIB")]
    pub memory: Option<f64>,
}

/// One number, or the same one twice.
fn square(text: &str) -> Result<usize, String> {
    let most = BenchPlan::MAX_SIZE;
    let (width, height) = text.split_once(['x', 'X', '×']).unwrap_or((text, text));
    let side = width.parse().ok().filter(|n| width == height && (1..=most).contains(n));
    side.ok_or_else(|| format!("a square is needed, such as 1024 or 1024x1024, with sides of 1 to {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_are_square() {
        assert_eq!((square("64"), square("64x64")), (Ok(64), Ok(64)));
        for wrong in ["", "0", "64x", "64x32", "9999", "64x64x64", "-1"] {
            assert!(square(wrong).is_err(), "{wrong}");
        }
    }
}
