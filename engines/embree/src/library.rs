//! The shared library: found in a folder or by the system, loaded, and left loaded.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use libloading::Library;
use libloading::os::unix::{Library as UnixLibrary, RTLD_GLOBAL, RTLD_NOW};
use rdh_engine_protocol::Absent;

use crate::abi::Abi;
use crate::api::Functions;

/// Loads a version of Embree: from the folder that its variable names, else from where `cargo xtask engines --fetch` puts
/// it, else from where the system keeps its libraries.
pub(crate) fn load<A: Abi>() -> Result<(Functions, A)> {
    let library = match folder::<A>() {
        Some(folder) => from_folder::<A>(&folder)?,
        None => open(Path::new(A::SONAME)).map_err(|_| {
            Absent(format!(
                "there is no {}; `cargo xtask engines --fetch` gets it, or {} names its folder",
                A::SONAME,
                A::VARIABLE
            ))
        })?,
    };
    Ok((Functions::look_up(library)?, A::find(library)?))
}

/// A folder that was named is taken as it is; the one beside the programs must hold the library.
fn folder<A: Abi>() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os(A::VARIABLE) {
        return Some(named.into());
    }
    let program = std::env::current_exe().ok()?;
    let fetched = program.parent()?.parent()?.join(A::FOLDER);
    find(&fetched, A::STEM).ok().flatten().map(|_| fetched)
}

/// The library, and before it the `libtbb*.so*` beside it, if there is one.
fn from_folder<A: Abi>(folder: &Path) -> Result<&'static Library> {
    if let Some(tbb) = find(folder, "libtbb")? {
        open(&tbb)?;
    }
    let library = find(folder, A::STEM)?;
    let library = library.ok_or_else(|| Absent(format!("{}: there is no {}*.so* in it", folder.display(), A::STEM)))?;
    open(&library)
}

/// The first file, by name, that begins with `stem` and is a shared library. Wheels put a hash into the names, and
/// `libtbbmalloc` is not what `libtbb` asks for.
fn find(folder: &Path, stem: &str) -> Result<Option<PathBuf>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let fits = |path: &PathBuf| {
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        let rest = name.strip_prefix(stem).unwrap_or("x");
        name.contains(".so") && rest.starts_with(['.', '-'])
    };
    let mut found: Vec<_> = entries.filter_map(|e| Some(e.ok()?.path())).filter(fits).collect();
    found.sort();
    Ok(found.into_iter().next())
}

/// Loads a library for the rest of the program, its symbols visible to those that follow.
fn open(path: &Path) -> Result<&'static Library> {
    // SAFETY: loading runs the library's initialisers. The user named the folder, so they trust what is in it; Embree
    // and TBB only set up their own state.
    let library = unsafe { UnixLibrary::open(Some(path), RTLD_NOW | RTLD_GLOBAL) };
    let library = library.with_context(|| path.display().to_string())?;
    // Never unloaded: function pointers into it stay valid.
    Ok(Box::leak(Box::new(library.into())))
}
