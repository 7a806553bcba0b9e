//! Arguments of `rdh cast`.

use std::path::PathBuf;
use std::str::FromStr;

use rdh::Spec;

/// Cast the rays of a NumPy file.
///
/// Rays are f4 or f8, of shape (n, 6), origins and directions, or (n, 8), with t_min and t_max; more sides in front are
/// kept. They are given in world coordinates. Answers: for nearest hits a structured array with t_hit (inf for a miss),
/// primitive_uvs and primitive_ids (4294967295 for a miss); with --any bool; with --count u4. Files may be larger than
/// memory.
#[derive(Debug, clap::Args)]
pub(crate) struct CastArgs {
    /// A saved tree; or a scene by id or a mesh file, for which one is built
    #[arg(value_name = "TREE|SCENE")]
    pub tree: String,
    /// The rays
    #[arg(long, value_name = "IN.npy")]
    pub rays: PathBuf,
    /// The answers
    #[arg(short, long, value_name = "OUT.npy")]
    pub output: PathBuf,
    /// Only whether anything is hit
    #[arg(long, conflicts_with = "count")]
    pub any: bool,
    /// How many triangles are hit
    #[arg(long)]
    pub count: bool,
    /// Only rays A to B (without B), counted from 0 over all sides: for job arrays
    #[arg(long, value_name = "A:B")]
    pub range: Option<Rows>,
    /// What to build for a scene [default: bvh8+sah]
    #[arg(long, value_name = "SPEC")]
    pub spec: Option<Spec>,
}

/// A range of rows, `A:B`; either may be left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rows {
    pub first: Option<u64>,
    pub end: Option<u64>,
}

impl FromStr for Rows {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |s: &str| if s.is_empty() { Some(None) } else { s.parse().ok().map(Some) };
        let rows = text.split_once(':').and_then(|(a, b)| Some(Self { first: side(a)?, end: side(b)? }));
        rows.ok_or_else(|| "A:B is needed, such as 1000:2000, :2000 or 1000:".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        assert_eq!("3:10".parse(), Ok(Rows { first: Some(3), end: Some(10) }));
        assert_eq!(":10".parse(), Ok(Rows { first: None, end: Some(10) }));
        assert_eq!(":".parse(), Ok(Rows { first: None, end: None }));
        for wrong in ["", "3", "a:b", "-1:3", "1:2:3", "1.5:2"] {
            assert!(wrong.parse::<Rows>().is_err(), "{wrong}");
        }
    }
}
