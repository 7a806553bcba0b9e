//! Files that lie: each is read right or refused with an error that names file and place, within bounds of memory and
//! time; and no mutation of a good file makes a reader panic.

mod hostile_files;

use std::path::Path;
use std::time::{Duration, Instant};

use hostile_files::memory::{self, Counting};
use hostile_files::{Case, Expect, seeds};
use rdh_scene::formats::{Context, format_of, read_file, read_file_at};
use rdh_scene::{Error, Scene};
use tempfile::TempDir;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What reading may take at most: 64 MiB, 16 times the file, and 64 bytes a triangle.
fn allowance(file_bytes: usize, scene: Option<&Scene>) -> usize {
    (64 << 20) + 16 * file_bytes + 64 * scene.map_or(0, Scene::triangle_count)
}

fn check(folder: &Path, case: &Case) {
    let path = folder.join(&case.name);
    std::fs::write(&path, &case.bytes).unwrap();
    let start = Instant::now();
    let (result, peak) = memory::peak_of(|| read_file(&path));
    let took = start.elapsed();
    let allowed = allowance(case.bytes.len(), result.as_ref().ok());
    assert!(peak <= allowed, "{}: took {peak} bytes of memory, {allowed} are allowed", case.name);
    // Far more than any needs, to be safe on a busy machine; what is guarded against takes minutes or for ever.
    assert!(took < Duration::from_secs(20), "{}: took {took:?}", case.name);
    match (&case.expect, result) {
        (Expect::Triangles(expected), Ok(scene)) => assert_eq!(scene.triangle_count(), *expected, "{}", case.name),
        (Expect::Error(reason), Err(error)) => check_error(&path, reason, &error),
        (expect, result) => {
            panic!("{}: expected {expect:?}, found {:?}", case.name, result.map(|s| s.triangle_count()))
        }
    }
}

fn check_error(path: &Path, reason: &str, error: &Error) {
    let text = error.to_string();
    assert!(text.starts_with(&format!("{}: ", path.display())), "{text}");
    assert!(text.contains(reason), "{text}");
    assert!(text.len() < 400, "{text}");
}

fn check_all(cases: Vec<Case>) {
    let folder = TempDir::new().unwrap();
    cases.iter().for_each(|case| check(folder.path(), case));
}

#[test]
fn stl_files_that_lie() {
    check_all(hostile_files::stl::cases());
}

#[test]
fn ply_files_that_lie() {
    check_all(hostile_files::ply::cases());
}

#[test]
fn obj_files_that_lie() {
    check_all(hostile_files::obj::cases());
}

#[test]
fn gltf_files_that_lie() {
    check_all(hostile_files::gltf::cases());
}

#[test]
fn gltf_files_that_ask_for_far_more_than_they_hold() {
    check_all(hostile_files::gltf::bombs());
}

#[test]
fn the_seeds_of_the_mutations_are_good() {
    check_all(seeds().into_iter().map(|(name, bytes)| Case::new(name, bytes, Expect::Triangles(12))).collect());
}

/// Mutates each seed some thousand times: bytes changed, cut out, doubled or replaced by telling ones. A result may be
/// anything but a panic or a mesh that breaks its own rules.
#[test]
fn no_mutation_makes_a_reader_panic() {
    let mut random = hostile_files::Random::new(1);
    for (name, seed) in seeds() {
        let format = format_of(Path::new(name)).unwrap();
        for round in 0..4000 {
            let bytes = hostile_files::mutated(&seed, &mut random);
            let context = Context { folder: None, time_secs: (round % 2 == 0).then_some(0.5) };
            let (result, peak) = memory::peak_of(|| (format.read)(&bytes, &context));
            assert!(peak <= allowance(bytes.len(), result.as_ref().ok()), "{name}, round {round}: {peak} bytes");
            if let Ok(scene) = result {
                scene.flatten().unwrap_or_else(|e| panic!("{name}, round {round}: {e}"));
            }
        }
    }
}

#[test]
fn every_truncation_of_a_seed_is_survived() {
    for (name, seed) in seeds() {
        let format = format_of(Path::new(name)).unwrap();
        for length in 0..seed.len() {
            drop((format.read)(&seed[..length], &Context::default()));
        }
    }
}

/// An endless device is no file, whatever its link is called.
#[cfg(target_os = "linux")]
#[test]
fn devices_and_pipes_are_refused() {
    let folder = TempDir::new().unwrap();
    for name in ["zero.obj", "zero.stl", "zero.ply", "zero.gltf", "zero.glb"] {
        let path = folder.path().join(name);
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        assert!(read_file_at(&path, Some(0.0)).unwrap_err().to_string().ends_with("is not a file"));
    }
}
