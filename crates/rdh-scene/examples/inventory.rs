//! Prints what is in mesh files: `cargo run --release -p rdh-scene --example inventory -- FILE_OR_FOLDER…`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use rdh_scene::formats::{Row, inventory, mesh_files};

fn main() -> ExitCode {
    let mut failed = false;
    println!(
        "{:<28} {:>10} {:>6} {:>10} {:>9} {:>8} {:>8}  dropped or repaired",
        "file", "triangles", "flat", "unique", "instances", "mirrored", "seconds"
    );
    for argument in std::env::args_os().skip(1) {
        for file in files(Path::new(&argument)) {
            match file.and_then(|path| inventory(&path)) {
                Ok(row) => print(&row),
                Err(error) => {
                    failed = true;
                    eprintln!("error: {error}");
                }
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// A file itself, or the mesh files of a folder.
fn files(path: &Path) -> Vec<rdh_scene::Result<PathBuf>> {
    if !path.is_dir() {
        return vec![Ok(path.to_owned())];
    }
    match mesh_files(path) {
        Ok(files) => files.into_iter().map(Ok).collect(),
        Err(error) => vec![Err(error)],
    }
}

fn print(row: &Row) {
    let notes: Vec<String> = row.notes.iter().map(|n| format!("{} {}", n.count, n.what)).collect();
    println!(
        "{:<28} {:>10} {:>6} {:>10} {:>9} {:>8} {:>8.3}  {}",
        row.path.file_name().unwrap_or_default().to_string_lossy(),
        row.triangles,
        row.zero_area,
        row.unique_triangles,
        row.instances,
        row.mirrored,
        row.read_secs,
        notes.join("; ")
    );
}
