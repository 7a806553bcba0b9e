//! Arguments of `rdh compare`.

use rdh_study::{Mode, Protocol, Source};

use super::values::{self, Size};

/// Build with each spec, cast the mode's rays through all of them, and print what they cost.
///
/// The first spec is the base: ratios below 1 are better than it. All specs must give the same answers for every ray;
/// a difference is exit code 3.
#[derive(Debug, clap::Args)]
pub(crate) struct CompareArgs {
    /// Scenes by id (balls4), views of them (balls4:front), or mesh files
    /// [default: the quick set; all scenes of --scenes DIR if that is given]
    #[arg(value_name = "SCENE")]
    pub names: Vec<String>,
    /// Of each scene its first view alone, unless another one is named
    #[arg(long)]
    pub first: bool,
    /// Of the scenes, those that are also summed up by themselves (dense ones, say): ids with commas between them
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub subset: Vec<String>,
    /// What to build: specs with commas between them [default: kd+sah,kd+rdh(paper),kd+rdh]
    #[arg(long, value_name = "LIST")]
    pub spec: Option<String>,
    /// Which rays, more than one with commas: primary, whitted, path, ao, lidar
    #[arg(long, value_name = "MODE", value_delimiter = ',', default_value = "primary")]
    pub mode: Vec<Mode>,
    /// Width and height of the film: one test ray a pixel [default: 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// How often all rays are cast, for timing [default: 5 in small scenes, 3 in large ones]
    #[arg(long, value_name = "N", value_parser = values::rounds)]
    pub rounds: Option<usize>,
    /// How training rays are chosen: unseen (other film positions, another seed; `default` is another name of it),
    /// paper (a subset of the frame's own rays), same (all test rays: the bound)
    #[arg(long, value_name = "NAME", default_value = "unseen")]
    pub protocol: Protocol,
    /// Where they come from, if not from the view itself: none, frame:1/N (this frame's pixels, through a first tree that is
    /// paid for), previous:K (frames ago, of an animation or a camera path), view:NAME, all
    #[arg(long, value_name = "SOURCE", conflicts_with = "protocol")]
    pub rrs: Option<Source>,
    /// How many training rays a view gets [default: 16384]
    #[arg(long, value_name = "N", value_parser = values::ray_count)]
    pub training: Option<usize>,
}
