//! Where Embree is, how to get it, and the program that calls it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// The wheel that holds Embree 4 for Linux on x86-64.
const WHEEL: &str = "embreex==4.4.0.post1";

/// The program that calls Embree, and the library's folder.
#[derive(Debug, Clone)]
pub(crate) struct Engine {
    /// The program.
    pub(crate) program: PathBuf,
    /// The folder of `libembree4`.
    pub(crate) lib: PathBuf,
}

/// The engine, built; the inner error says why there is none, which is no failure.
///
/// # Errors
/// The engine is there and can't be built, or a folder that was named has no library.
pub(crate) fn engine(named: Option<&Path>) -> Result<Result<Engine, String>> {
    let from_environment = std::env::var_os("EMBREE_LIB").map(PathBuf::from);
    let lib = match named.map(Path::to_path_buf).or(from_environment) {
        Some(lib) => {
            ensure!(holds_embree(&lib), "{}: there is no libembree4*.so* in it", lib.display());
            lib
        }
        None if holds_embree(&fetched()) => fetched(),
        None => {
            return Ok(Err(
                "it is not installed; get it by `cargo xtask engines --fetch`, or name its folder by --lib".into(),
            ));
        }
    };
    Ok(Ok(Engine { program: build()?, lib }))
}

/// Downloads the wheel by pip and unpacks its libraries into `target/engines`.
pub(crate) fn fetch() -> Result<()> {
    if holds_embree(&fetched()) {
        eprintln!("embree: {} is there already", fetched().display());
        return Ok(());
    }
    let folder = target();
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let python = |arguments: &[&str]| {
        let status = Command::new("python3").args(arguments).current_dir(&folder).status().context("python3")?;
        ensure!(status.success(), "python3 {}: {status}", arguments.join(" "));
        Ok(())
    };
    python(&["-m", "pip", "download", "--quiet", "--no-deps", "--dest", ".", WHEEL])?;
    let wheels = std::fs::read_dir(&folder)?.filter_map(|e| Some(e.ok()?.file_name().to_string_lossy().into_owned()));
    match wheels.into_iter().find(|name| name.starts_with("embreex-") && name.ends_with(".whl")) {
        Some(wheel) => python(&["-m", "zipfile", "-e", &wheel, "."])?,
        None => bail!("pip downloaded no wheel of {WHEEL}"),
    }
    ensure!(holds_embree(&fetched()), "the wheel holds no libembree4");
    Ok(())
}

fn build() -> Result<PathBuf> {
    let manifest = root().join("engines/embree/Cargo.toml");
    let target = target().join("embree");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--release", "--quiet", "--locked", "--manifest-path"]).arg(manifest);
    let status = command.arg("--target-dir").arg(&target).status().context("cargo")?;
    ensure!(status.success(), "engines/embree can't be built: {status}");
    Ok(target.join("release").join(format!("rdh-engine-embree{}", std::env::consts::EXE_SUFFIX)))
}

fn holds_embree(folder: &Path) -> bool {
    let names = std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| Some(e.ok()?.file_name()));
    names.into_iter().any(|name| {
        let name = name.to_string_lossy();
        name.starts_with("libembree4") && name.contains(".so")
    })
}

fn fetched() -> PathBuf {
    target().join("embreex.libs")
}

fn target() -> PathBuf {
    root().join("target/engines")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_path_buf()
}
