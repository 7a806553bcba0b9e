//! Arguments of `rdh record`.

use std::path::PathBuf;

use rdh_study::Mode;

use super::values::{self, Size};

/// Record the rays of a mode as a profile.
///
/// Casts one path a pixel and keeps a fair sample of the rays, with where they ended and what they were for.
#[derive(Debug, clap::Args)]
pub(crate) struct RecordArgs {
    /// A scene by id, a view of it (balls4:front, traffic:street@3 at a frame), or a mesh file
    #[arg(value_name = "SCENE[:VIEW]")]
    pub scene: String,
    /// Which rays: primary, whitted, path, ao, lidar
    #[arg(long, value_name = "MODE", default_value = "primary")]
    pub mode: Mode,
    /// How many distinct rays are kept at most
    #[arg(long, value_name = "N", value_parser = values::ray_count, default_value_t = 65_536)]
    pub capacity: usize,
    /// Width and height of the film: one path a pixel
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    pub size: Size,
    /// The profile to write
    #[arg(short, long, value_name = "F.rays")]
    pub output: PathBuf,
}
