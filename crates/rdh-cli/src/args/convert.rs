//! Arguments of `rdh convert`.

use std::path::PathBuf;

use rdh::Query;

/// Convert between files of meshes, and between files of rays.
///
/// Meshes: any scene, mesh file or saved tree to OBJ, PLY, STL or GLB. Rays: a profile to a NumPy array of shape (n, 8),
/// without what the rays were for; and an array of (n, 6) or (n, 8) to a profile. Trees are made by `rdh build`.
#[derive(Debug, clap::Args)]
pub(crate) struct ConvertArgs {
    /// What to read
    #[arg(value_name = "IN")]
    pub input: String,
    /// What to write: .obj, .ply, .stl, .glb; .npy, .rays
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    /// What the rays of an array ask: closest, occluded, all
    #[arg(long, value_name = "QUERY", value_parser = query, default_value = "closest")]
    pub query: Query,
}

fn query(text: &str) -> Result<Query, String> {
    let known = || Query::ALL.map(Query::name).join(", ");
    Query::ALL.into_iter().find(|query| query.name() == text).ok_or_else(|| format!("known are {}", known()))
}
