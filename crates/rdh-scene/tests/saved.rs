//! Saved trees on disk: opened, replaced, damaged, and read as scenes.

use std::fs;

use rdh::{Accel, BuildOptions, Mesh, Provenance, Ray, Training, build};
use rdh_scene::formats::read_file;
use rdh_scene::saved::{Setting, open, open_copy, save};
use rdh_scene::{View, catalog};
use serde_json::json;
use tempfile::TempDir;

fn tree(height: f32) -> Accel {
    let positions = vec![[0.0, 0.0, height], [1.0, 0.0, height], [0.0, 1.0, height]];
    let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
    build(&mesh, &"bvh8+sah".parse().unwrap(), &Training::none(), &BuildOptions::default()).unwrap()
}

fn setting() -> Setting {
    let view = View {
        name: "top".to_owned(),
        eye: [1000.25, 2000.25, 9.0],
        target: [1000.25, 2000.25, 0.0],
        up: [0.0, 1.0, 0.0],
        fov_y_degrees: 30.0,
    };
    Setting { id: "far".to_owned(), origin: [1000.0, 2000.0, 0.0], up: [0.0, 0.0, 1.0], views: vec![view] }
}

fn height(accel: &Accel) -> Option<f32> {
    accel.closest(&Ray::new([0.25, 0.25, 0.0], [0.0, 0.0, 1.0])).map(|hit| hit.t)
}

#[test]
fn an_open_tree_outlives_its_replacement() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("a.rdh");
    save(&tree(1.0), &file).unwrap();
    let (mapped, copied) = (open(&file).unwrap(), open_copy(&file).unwrap());
    save(&tree(2.0), &file).unwrap();
    assert_eq!([&mapped, &copied, &open(&file).unwrap()].map(height), [Some(1.0), Some(1.0), Some(2.0)]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn what_is_no_tree_is_named_with_its_byte() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("a.rdh");
    let bytes = tree(1.0).to_bytes().unwrap();
    let mut altered = bytes.clone();
    altered[100] ^= 1;
    for (content, expected) in [
        (&b""[..], "byte 0: the file ends within its header of 64 bytes"),
        (b"v 0 0 0\n", "byte 0: this is not a .rdh file"),
        (&bytes[..200], "byte 200: 200 bytes, but the file should have"),
        (&altered, "byte 16: the checksum does not match"),
    ] {
        fs::write(&file, content).unwrap();
        let errors = [open(&file).map(|_| ()), open_copy(&file).map(|_| ()), read_file(&file).map(|_| ())];
        for error in errors.map(|e| e.unwrap_err().to_string()) {
            assert!(error.starts_with(&format!("{}: {expected}", file.display())), "{error}");
        }
    }
    assert!(open(folder.path()).unwrap_err().to_string().ends_with("is not a file"));
    assert!(save(&tree(1.0), &folder.path().join("none/a.rdh")).is_err());
}

#[test]
fn a_tree_is_a_scene_with_its_origin_and_views() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("a.rdh");
    let plain = tree(1.0);
    save(&plain, &file).unwrap();
    let scene = read_file(&file).unwrap();
    assert_eq!((scene.triangle_count(), scene.origin, scene.views.len()), (1, [0.0; 3], 0));
    let settings = json!({ "scene": setting() });
    let accel = plain.with_provenance(Provenance { settings, ..Provenance::default() });
    save(&accel, &file).unwrap();
    let scene = read_file(&file).unwrap();
    assert_eq!((scene.origin, &scene.views, scene.up), (setting().origin, &setting().views, setting().up));
    assert_eq!(scene.flatten().unwrap().mesh, *accel.mesh());
    let entry = catalog::find(file.to_str().unwrap(), &[]).unwrap();
    assert_eq!(entry.views, setting().views);
    assert_eq!(Setting::from_settings(&open(&file).unwrap().provenance().settings), Some(setting()));
}
