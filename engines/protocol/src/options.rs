//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

/// What is to be built, and where answers go.
#[derive(Debug)]
pub struct Options {
    /// The mesh file.
    pub mesh: PathBuf,
    /// What the competitor builds, by a name of its own.
    pub mode: String,
    /// The file that `answers` writes.
    pub answers: Option<PathBuf>,
}

impl Options {
    /// Parses what follows the program's name.
    ///
    /// # Errors
    /// An unknown or incomplete option.
    pub fn parse(mut args: impl Iterator<Item = OsString>) -> Result<Self> {
        let (mut mesh, mut mode, mut answers) = (None, None, None);
        while let Some(arg) = args.next() {
            let mut value = || args.next().with_context(|| format!("{} needs a value", arg.display()));
            match arg.to_str().unwrap_or_default() {
                "--mesh" => mesh = Some(value()?.into()),
                "--mode" => mode = Some(value()?.to_string_lossy().into_owned()),
                "--answers" => answers = Some(value()?.into()),
                _ => bail!("unknown option {}; known: --mesh, --mode, --answers", arg.display()),
            }
        }
        let (mesh, mode) = (mesh.context("--mesh FILE is needed")?, mode.context("--mode NAME is needed")?);
        Ok(Self { mesh, mode, answers })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_unknown_is_accepted() {
        let parse = |text: &str| Options::parse(text.split(' ').map(OsString::from));
        let options = parse("--mode high-avx2 --mesh a.mesh").unwrap();
        assert_eq!((options.mode.as_str(), options.answers), ("high-avx2", None));
        for wrong in ["--mesh a.mesh", "--mode m", "--mesh a --mode", "--mesh a --mode m --fast"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
