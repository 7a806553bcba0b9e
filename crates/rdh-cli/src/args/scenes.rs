//! Arguments of `rdh scenes`.

/// List scenes and their views, or say what is in mesh files.
///
/// Without files: the embedded scenes, and those of --scenes DIR. With files: what each of them holds, what was dropped
/// on the way in, and how long reading took.
#[derive(Debug, clap::Args)]
pub(crate) struct ScenesArgs {
    /// Mesh files (OBJ, PLY, STL, glTF, GLB), folders of them, or ids of scenes
    #[arg(value_name = "FILE")]
    pub files: Vec<String>,
}
