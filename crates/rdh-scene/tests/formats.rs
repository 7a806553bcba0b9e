//! Reading mesh files from disk: by extension, several as one, and with buffers beside them.

use std::fs;
use std::path::{Path, PathBuf};

use rdh_scene::Scene;
use rdh_scene::formats::{FORMATS, format_of, read_file, read_files};
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, bytes).unwrap();
    path
}

fn first_corner(scene: &Scene, instance: usize) -> [f64; 3] {
    let instance = &scene.instances[instance];
    let geometry = &scene.geometries[instance.geometry];
    let p = instance.scene_from_object.point(geometry.positions[0].map(f64::from));
    [0, 1, 2].map(|axis| p[axis] + scene.origin[axis])
}

#[test]
fn extensions_count_in_any_case() {
    for (name, format) in
        [("a.obj", "obj"), ("a.b.STL", "stl"), ("A.Ply", "ply"), ("x.glTF", "gltf"), ("x.GLB", "glb"), ("x.rdh", "rdh")]
    {
        assert_eq!(format_of(Path::new(name)).unwrap().name, format);
    }
    let known = FORMATS.iter().map(|f| f.name).collect::<Vec<_>>().join(", ");
    for (name, found) in [("a.fbx", "unknown file extension 'fbx'"), ("obj", "no file extension")] {
        let error = format_of(Path::new(name)).unwrap_err().to_string();
        assert_eq!(error, format!("{name}: {found}; the known ones are {known}"));
    }
}

#[test]
fn errors_name_the_file() {
    let folder = TempDir::new().unwrap();
    let bad = write(&folder, "bad.obj", "v 0 0 x");
    assert_eq!(read_file(&bad).unwrap_err().to_string(), format!("{}: line 1: 'x' is not a number", bad.display()));
    let missing = folder.path().join("missing.ply");
    assert!(read_file(&missing).unwrap_err().to_string().starts_with(&format!("{}: ", missing.display())));
    fs::create_dir(folder.path().join("folder.stl")).unwrap();
    assert!(read_file(&folder.path().join("folder.stl")).unwrap_err().to_string().ends_with("is not a file"));
    let good = write(&folder, "good.obj", TRIANGLE);
    assert_eq!(read_files(&[good, bad.clone()]).unwrap_err().file, Some(bad));
}

#[test]
fn files_are_joined_in_order_under_one_origin() {
    let folder = TempDir::new().unwrap();
    let far = TRIANGLE.replace("v 0 ", "v 447500.123 ").replace("v 1 ", "v 447501.123 ");
    let (near, far) = (write(&folder, "near.obj", TRIANGLE), write(&folder, "far.obj", far));
    // Far from zero together: one origin for both.
    let other = write(&folder, "other.obj", fs::read_to_string(&far).unwrap().replace(".123", ".456"));
    let both = read_files(&[far.clone(), other]).unwrap();
    assert_eq!((both.name.as_str(), both.triangle_count()), ("far+other", 2));
    assert_ne!(both.origin, [0.0; 3]);
    assert!((first_corner(&both, 0)[0] - 447500.123).abs() < 1e-6);
    assert!((first_corner(&both, 1)[0] - 447500.456).abs() < 1e-6);
    // One here and one there: no origin suits both better than zero.
    let apart = read_files(&[near.clone(), far.clone()]).unwrap();
    assert_eq!(apart.origin, [0.0; 3]);
    assert_eq!(first_corner(&apart, 0), [0.0; 3]);
    assert!((first_corner(&apart, 1)[0] - 447500.123).abs() < 1e-6);
    // One alone is as it was read.
    let alone = read_files(std::slice::from_ref(&far)).unwrap();
    assert_eq!(
        (alone.origin, alone.geometries),
        (read_file(&far).unwrap().origin, read_file(&far).unwrap().geometries)
    );
}

/// A document of one triangle, whose buffer is where `uri` says.
fn document(uri: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "buffers": [{{"byteLength": 36, "uri": "{uri}"}}], "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}]}}"#
    )
}

#[test]
fn buffers_may_lie_beneath_the_documents_folder_only() {
    let folder = TempDir::new().unwrap();
    let triangle: Vec<u8> =
        [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    write(&folder, "secret.bin", &triangle);
    write(&folder, "inner/a.bin", &triangle);
    write(&folder, "inner/deep/b c.bin", &triangle);
    write(&folder, "inner/short.bin", &triangle[..35]);
    let read = |uri: &str| read_file(&write(&folder, "inner/x.gltf", document(uri)));
    for uri in ["a.bin", "./a.bin", "deep/b%20c.bin", "deep/b c.bin", "deep/../a.bin", "%61.bin"] {
        assert_eq!(read(uri).unwrap().triangle_count(), 1, "{uri}");
    }
    let secret = folder.path().join("secret.bin");
    let secret = secret.to_str().unwrap();
    let refused = [
        ("../secret.bin", "lies outside the document's folder"),
        ("deep/../../secret.bin", "lies outside the document's folder"),
        ("%2e%2e/secret.bin", "lies outside the document's folder"),
        (secret, "is not named by a relative path"),
        ("file:///etc/passwd", "is not named by a relative path"),
        ("https://example.org/a.bin", "is not named by a relative path"),
        ("%ff.bin", "is not named by a relative path"),
        ("a%2", "is not named by a relative path"),
        ("", "is not named by a relative path"),
        ("deep", "is not a file"),
        ("short.bin", "claims 36 bytes, but only 35 are there"),
        ("none.bin", "file 'none.bin': "),
    ];
    for (uri, reason) in refused {
        let error = read(uri).unwrap_err().to_string();
        assert!(error.contains("buffer 0: ") && error.contains(reason), "{uri}: {error}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(secret, folder.path().join("inner/link.bin")).unwrap();
        assert!(read("link.bin").unwrap_err().to_string().contains("lies outside"));
    }
}

#[test]
fn a_document_may_be_named_without_a_folder() {
    // Tests run in the crate's folder; the name is all there is.
    let name = PathBuf::from("formats-test-without-folder.gltf");
    let bin = PathBuf::from("formats-test-without-folder.bin");
    fs::write(&name, document(bin.to_str().unwrap())).unwrap();
    fs::write(&bin, [0; 36]).unwrap();
    let read = read_file(&name);
    fs::remove_file(&name).unwrap();
    fs::remove_file(&bin).unwrap();
    assert_eq!(read.unwrap().triangle_count(), 1);
}
