//! `cargo xtask engines`: gets and builds the competitors that `rdh bench` races.
//!
//! ```text
//!  build        the programs of engines/, each to its best, into target/engines/bin
//!  fetch        libraries that come as binaries: Embree 4 from a wheel, Embree 3 from Debian
//! ```

mod build;
mod fetch;

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// Get and build the competitors that `rdh bench` races.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Packages of engines/ to build; without any, all
    package: Vec<String>,
    /// Get the libraries that come as binaries first
    #[arg(long)]
    fetch: bool,
}

/// Gets what is asked for, and builds; one that can't be had doesn't keep the others from it.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let folder = folder()?;
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let mut missing = Vec::new();
    if arguments.fetch {
        missing.extend(fetch::all(&folder));
    }
    let failed = build::all(&arguments.package, &folder)?;
    for (name, why) in missing.iter().chain(&failed) {
        eprintln!("{name}: skipped: {why:#}");
    }
    eprintln!("the programs are in {}", folder.join("bin").display());
    if failed.is_empty() { Ok(()) } else { bail!("{} programs can't be built", failed.len()) }
}

/// `engines` beside the folder of this program's profile, so that `rdh` finds it from its own place.
fn folder() -> Result<PathBuf> {
    Ok(crate::target()?.join("engines"))
}

/// The folder of the competitors' sources.
fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).join("engines")
}

/// Runs a command in a folder.
fn call(command: &mut Command, folder: &Path) -> Result<()> {
    let name = command.get_program().display().to_string();
    let status = command.current_dir(folder).status().with_context(|| name.clone())?;
    ensure!(status.success(), "{name}: {status}");
    Ok(())
}
