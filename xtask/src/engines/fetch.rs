//! Libraries that come as binaries, unpacked into the folder of engines; nothing is installed in the system.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Error, Result, ensure};

use super::call;

/// The wheel that holds Embree 4 for Linux on x86-64.
const WHEEL: &str = "embreex==4.4.0.post1";

/// Debian's packages of Embree 3, and of the threads that it wants.
const PACKAGES: [&str; 2] = ["libembree3-3", "libtbb12"];

/// Gets all of them; gives those that can't be had, and why.
pub(super) fn all(folder: &Path) -> Vec<(String, Error)> {
    let libraries: [(&str, &str, Fetch); 2] =
        [("embree4", "embreex.libs", embree4), ("embree3", "embree3/usr/lib/x86_64-linux-gnu", embree3)];
    let mut missing = Vec::new();
    for (name, place, fetch) in libraries {
        let place = folder.join(place);
        if holds_library(&place, name) {
            eprintln!("{name}: it is in {} already", place.display());
            continue;
        }
        let fetched = fetch(folder).and_then(|()| {
            ensure!(holds_library(&place, name), "what was got holds no lib{name}");
            Ok(())
        });
        missing.extend(fetched.err().map(|why| (name.to_owned(), why)));
    }
    missing
}

type Fetch = fn(&Path) -> Result<()>;

fn embree4(folder: &Path) -> Result<()> {
    let python = |arguments: &[&str]| call(Command::new("python3").args(arguments), folder);
    python(&["-m", "pip", "download", "--quiet", "--no-deps", "--dest", ".", WHEEL])?;
    let wheel = find(folder, "embreex-", ".whl").with_context(|| format!("pip downloaded no wheel of {WHEEL}"))?;
    python(&["-m", "zipfile", "-e", &wheel.to_string_lossy(), "."])
}

fn embree3(folder: &Path) -> Result<()> {
    call(Command::new("apt-get").args(["download", "--quiet"]).args(PACKAGES), folder)?;
    for package in PACKAGES {
        let file = find(folder, package, ".deb").with_context(|| format!("apt-get downloaded no {package}"))?;
        call(Command::new("dpkg-deb").arg("-x").arg(file).arg("embree3"), folder)?;
    }
    Ok(())
}

fn holds_library(folder: &Path, name: &str) -> bool {
    names(folder).any(|file| file.starts_with(&format!("lib{name}")) && file.contains(".so"))
}

fn find(folder: &Path, begin: &str, end: &str) -> Option<PathBuf> {
    names(folder).find(|name| name.starts_with(begin) && name.ends_with(end)).map(|name| folder.join(name))
}

fn names(folder: &Path) -> impl Iterator<Item = String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.filter_map(|e| Some(e.ok()?.file_name().to_string_lossy().into_owned()))
}
