//! The shared library: found in a folder, loaded, and left loaded.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use libloading::Library;
use libloading::os::unix::{Library as UnixLibrary, RTLD_GLOBAL, RTLD_NOW};

use crate::api::Functions;

/// Embree's functions.
#[derive(Debug)]
pub(crate) struct Embree {
    pub(crate) functions: Functions,
}

impl Embree {
    /// Loads `libembree4*.so*` from a folder, and before it the `libtbb*.so*` beside it, if there is one.
    pub(crate) fn load(folder: &Path) -> Result<Self> {
        if let Some(tbb) = find(folder, "libtbb")? {
            open(&tbb)?;
        }
        let Some(embree) = find(folder, "libembree4")? else {
            bail!("{}: there is no libembree4*.so*; engines/README.md says how to get it", folder.display());
        };
        let library = open(&embree)?;
        let functions = Functions::find(library).with_context(|| embree.display().to_string())?;
        Ok(Self { functions })
    }
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
