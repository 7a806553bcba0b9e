//! Files that nobody ever sees half of.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file as a whole: under a temporary name in the same folder, then renamed.
///
/// # Errors
/// What the system says; nothing is left behind then, and a file that was there stays as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with(path, |out| out.write_all(bytes))
}

/// [`write_whole`], of what `write` writes: for files that need not be in memory at once.
///
/// # Errors
/// As [`write_whole`], and what `write` says.
pub fn write_with<T>(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>) -> io::Result<T> {
    let temporary = temporary_name(path);
    let written = write_and_rename(&temporary, path, write);
    if written.is_err() {
        // What is left of it is of no use; the first error is the one to report.
        let _ = fs::remove_file(&temporary);
    }
    written
}

fn write_and_rename<T>(
    temporary: &Path,
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>,
) -> io::Result<T> {
    let mut out = BufWriter::new(File::create_new(temporary)?);
    let result = write(&mut out)?;
    out.flush()?;
    out.get_ref().sync_all()?;
    fs::rename(temporary, path)?;
    Ok(result)
}

/// Differs between processes, so that two that write the same file don't write into each other's.
fn temporary_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.tmp", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.rays");
        write_whole(&file, b"first").unwrap();
        write_whole(&file, b"second").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"second");
        let failed = write_with(&file, |out| out.write_all(b"third").and(Err::<(), _>(io::Error::other("full"))));
        assert!(failed.is_err());
        assert_eq!(fs::read(&file).unwrap(), b"second");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
