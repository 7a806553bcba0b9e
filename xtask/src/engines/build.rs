//! The programs of `engines/`, built to their best: one unit, optimised across crates, with this machine's instructions.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Error, Result};

use super::{call, sources};

/// Packages of `engines/` that make programs.
const PACKAGES: [&str; 6] = [
    "rdh-engine-embree",
    "rdh-engine-obvhs",
    "rdh-engine-tinybvh",
    "rdh-engine-parry3d",
    "rdh-engine-bvh",
    "rdh-engine-kdtree-ray",
];

/// Builds packages, and copies their programs into `bin`; gives those that can't be built, and why.
pub(super) fn all(wanted: &[String], folder: &Path) -> Result<Vec<(String, Error)>> {
    let packages: Vec<&str> = match wanted {
        [] => PACKAGES.to_vec(),
        _ => wanted.iter().map(String::as_str).collect(),
    };
    let target = folder.join("build");
    let mut failed = Vec::new();
    for package in packages {
        eprintln!("{package}: building");
        failed.extend(build(package, &target).err().map(|why| (package.to_owned(), why)));
    }
    copy(&target.join("release"), &folder.join("bin"))?;
    Ok(failed)
}

/// In the folder of the sources, because cargo looks there for the flags in `.cargo/config.toml`.
fn build(package: &str, target: &Path) -> Result<()> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--release", "--quiet", "--locked", "--package", package, "--target-dir"]).arg(target);
    call(&mut command, &sources())
}

/// All programs of engines, under their own names.
fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in std::fs::read_dir(from).with_context(|| from.display().to_string())? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let program = name.starts_with("rdh-engine-") && name.ends_with(std::env::consts::EXE_SUFFIX);
        if program && !name.ends_with(".d") {
            // Renamed into place: a program that runs can't be written over, and nobody starts half of one.
            let temporary = to.join(format!(".{name}.{}.tmp", std::process::id()));
            std::fs::copy(&path, &temporary).with_context(|| path.display().to_string())?;
            std::fs::rename(&temporary, to.join(&name)).with_context(|| to.join(&name).display().to_string())?;
        }
    }
    Ok(())
}
