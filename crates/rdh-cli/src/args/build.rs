//! Arguments of `rdh build`.

use std::path::PathBuf;

use rdh::Spec;

/// Build a structure and save it.
///
/// With a profile, half of its rays are built for, and a quarter, by which nothing is built, is saved beside the tree, so
/// that `rdh verify` can judge it. A profile that is a training set already (`rdh rays --split`) is built for as a whole.
#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    /// A scene by id, a mesh file, or a saved tree, whose mesh is taken
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// What to build [default: bvh8+sah; with --rays bvh8+rdh]
    #[arg(long, value_name = "SPEC")]
    pub spec: Option<Spec>,
    /// The rays to build for
    #[arg(long, value_name = "F.rays")]
    pub rays: Option<PathBuf>,
    /// The tree to write
    #[arg(short, long, value_name = "F.rdh")]
    pub output: PathBuf,
}
