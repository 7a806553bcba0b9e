//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

/// What is to be built, and with what.
#[derive(Debug)]
pub(crate) struct Options {
    /// The folder of the shared libraries.
    pub(crate) lib: PathBuf,
    /// The mesh file.
    pub(crate) mesh: PathBuf,
    /// How carefully the tree is built.
    pub(crate) quality: Quality,
    /// Whether edges are watertight (Embree's are not by default).
    pub(crate) robust: bool,
    /// Embree's name of an instruction set: sse2, sse4.2, avx, avx2, avx512. Its own choice if there is none.
    pub(crate) isa: Option<String>,
}

/// How carefully the tree is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Binned SAH.
    Medium,
    /// With spatial splits.
    High,
}

impl Options {
    pub(crate) fn parse(args: impl Iterator<Item = OsString>) -> Result<Self> {
        let (mut args, mut lib, mut mesh) = (args, std::env::var_os("EMBREE_LIB").map(PathBuf::from), None);
        let (mut quality, mut robust, mut isa) = (Quality::High, false, None);
        while let Some(arg) = args.next() {
            let mut value = || args.next().with_context(|| format!("{} needs a value", arg.display()));
            match arg.to_str().unwrap_or_default() {
                "--lib" => lib = Some(value()?.into()),
                "--mesh" => mesh = Some(value()?.into()),
                "--robust" => robust = true,
                "--isa" => isa = Some(checked_isa(value()?)?),
                "--quality" => quality = parse_quality(&value()?)?,
                _ => bail!("unknown option {}; known: --lib, --mesh, --quality, --robust, --isa", arg.display()),
            }
        }
        let lib = lib.context("where is libembree4? Give --lib DIR or set EMBREE_LIB")?;
        Ok(Self { lib, mesh: mesh.context("--mesh FILE is needed")?, quality, robust, isa })
    }
}

fn parse_quality(text: &OsString) -> Result<Quality> {
    match text.to_str() {
        Some("medium") => Ok(Quality::Medium),
        Some("high") => Ok(Quality::High),
        _ => bail!("unknown quality {}; known: medium, high", text.display()),
    }
}

/// Embree takes its options as one text, in which a comma would begin another option.
fn checked_isa(text: OsString) -> Result<String> {
    const KNOWN: [&str; 5] = ["sse2", "sse4.2", "avx", "avx2", "avx512"];
    match text.to_str() {
        Some(isa) if KNOWN.contains(&isa) => Ok(isa.to_owned()),
        _ => bail!("unknown instruction set {}; known: {}", text.display(), KNOWN.join(", ")),
    }
}
