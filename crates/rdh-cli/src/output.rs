//! What goes to standard output and to files.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context as _, Result};
use serde::Serialize;

/// Writes text to standard output.
///
/// Unlike `print!` it returns errors: a reader that closed the pipe is none of our failures.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())?;
    Ok(out.flush()?)
}

/// Writes a document to standard output as JSON.
pub(crate) fn print_json(document: &impl Serialize) -> Result<()> {
    print(&(serde_json::to_string_pretty(document)? + "\n"))
}

/// Writes a file as a whole; nobody ever sees half of it.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    rdh_scene::files::write_whole(path, bytes).with_context(|| format!("{} can't be written", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let error = write_file(Path::new("no-such-folder/a.rays"), b"").unwrap_err();
        assert!(error.to_string().contains("no-such-folder"), "{error}");
    }
}
