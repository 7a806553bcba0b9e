//! Meshes written and read again.

use rdh::Mesh;
use rdh_scene::formats::{WRITERS, read_file, write_file};
use rdh_scene::{Scene, catalog};
use tempfile::TempDir;

/// The corners of all triangles in world coordinates, in order.
fn corners(mesh: &Mesh, origin: [f64; 3]) -> Vec<[f64; 3]> {
    let corner = |&i: &u32| mesh.positions()[i as usize];
    let world = |p: [f32; 3]| [0, 1, 2].map(|a| origin[a] + f64::from(p[a]));
    mesh.triangles().iter().flatten().map(corner).map(world).collect()
}

fn read(path: &std::path::Path) -> Vec<[f64; 3]> {
    let scene: Scene = read_file(path).unwrap();
    assert!(scene.notes.iter().all(|note| note.what == "facet normals"), "{:?}", scene.notes);
    corners(&scene.flatten().unwrap().mesh, scene.origin)
}

#[test]
fn what_is_written_is_read_bit_for_bit() {
    let folder = TempDir::new().unwrap();
    let scene = catalog::find("sombrero1", &[]).unwrap().load(0).unwrap();
    let mesh = scene.flatten().unwrap().mesh;
    assert!(mesh.len() > 1000);
    for writer in WRITERS {
        let file = folder.path().join(format!("a.{}", writer.name));
        assert_eq!(write_file(&file, &mesh, [0.0; 3]).unwrap(), vec![]);
        assert_eq!(read(&file), corners(&mesh, [0.0; 3]), "{}", writer.name);
    }
}

#[test]
fn a_far_origin_is_kept_or_noted() {
    let folder = TempDir::new().unwrap();
    let mesh = Mesh::new(vec![[0.125, 0.0, 3.0], [1.0, 0.5, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let origin = [84_864.0, 447_616.0, 0.0];
    for writer in WRITERS {
        let file = folder.path().join(format!("a.{}", writer.name));
        let notes = write_file(&file, &mesh, origin).unwrap();
        let exact = read(&file) == corners(&mesh, origin);
        assert!(exact || !notes.is_empty(), "{}", writer.name);
        assert_eq!(notes.is_empty(), writer.name != "stl");
    }
}

#[test]
fn an_empty_mesh_is_an_empty_file() {
    let folder = TempDir::new().unwrap();
    for writer in WRITERS {
        let file = folder.path().join(format!("a.{}", writer.name));
        write_file(&file, &Mesh::default(), [0.0; 3]).unwrap();
        // What reads it may say that there is nothing in it.
        assert!(read_file(&file).map_or(true, |scene| scene.triangle_count() == 0), "{}", writer.name);
    }
}

#[test]
fn unknown_formats_name_the_known_ones() {
    let error = write_file(std::path::Path::new("a.fbx"), &Mesh::default(), [0.0; 3]).unwrap_err().to_string();
    assert_eq!(error, "a.fbx: meshes are written as obj, ply, stl, glb");
}
