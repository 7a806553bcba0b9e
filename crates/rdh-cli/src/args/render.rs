//! Arguments of `rdh render`.

use std::path::PathBuf;

use rdh_study::Mode;

use super::values::{self, Size, Slice};

/// Draw a picture: shaded, a heat map of costs, or a slice through the cells.
///
/// With several specs heat maps and slices stand side by side on a common scale. Specs with a ray heuristic are trained on
/// the mode's training rays of the view, as in `compare`.
#[derive(Debug, clap::Args)]
pub(crate) struct RenderArgs {
    /// A scene by id, a view of it (balls4:front), or a mesh file
    #[arg(value_name = "SCENE[:VIEW]")]
    pub scene: String,
    /// The view, if it is not named with the scene
    #[arg(long, value_name = "NAME")]
    pub view: Option<String>,
    /// Which rays: primary, whitted, path, ao, lidar
    #[arg(long, value_name = "MODE", default_value = "primary")]
    pub mode: Mode,
    /// What to build: specs with commas between them [default: kd+sah for shading, kd+sah,kd+rdh else]
    #[arg(long, value_name = "LIST")]
    pub spec: Option<String>,
    /// Width and height of the film
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    pub size: Size,
    /// Colour pixels by what their rays cost; `diff` adds what the other specs' steps differ from the first one's
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with = "slice")]
    pub heat: Option<Heat>,
    /// Cut the cells by a plane and draw the training rays near it: x:0.5 (world coordinates), y:40%, z:eye
    #[arg(long, value_name = "AXIS:POS", allow_hyphen_values = true)]
    pub slice: Option<Slice>,
    /// Magnify a slice around the view's target
    #[arg(long, value_name = "FACTOR", value_parser = values::zoom, default_value = "1", requires = "slice")]
    pub zoom: f32,
    /// How many training rays
    #[arg(long, value_name = "N", value_parser = values::ray_count, default_value_t = 16_384)]
    pub training: usize,
    /// The picture to write; an EXR holds linear colours, or the numbers behind a heat map
    #[arg(short, long, value_name = "F.png|F.exr")]
    pub output: PathBuf,
}

/// What a heat map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Heat {
    /// Nodes visited
    Steps,
    /// Triangles tested
    Tests,
    /// Nodes visited, and the difference to the first spec
    Diff,
}
