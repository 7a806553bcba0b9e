//! Reads the third-party scenes that lie beside the repository, and checks them against what their index, their own
//! headers and each other say. Without the folder there is nothing to test.

use std::path::{Path, PathBuf};

use rdh_scene::formats::{inventory, mesh_files, read_file, read_file_at};
use rdh_scene::{Scene, catalog};

/// The folder, if it is there.
fn folder() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    let found = folder.join("scenes.toml").is_file();
    if !found {
        eprintln!("skipped: there is no {}", folder.display());
    }
    found.then(|| folder.to_owned())
}

/// All corners of all instances, in world coordinates.
fn world(scene: &Scene) -> impl Iterator<Item = [[f64; 3]; 3]> + '_ {
    scene.instances.iter().flat_map(move |instance| {
        let geometry = &scene.geometries[instance.geometry];
        let there = move |i: u32| {
            let p = instance.scene_from_object.point(geometry.positions[i as usize].map(f64::from));
            [0, 1, 2].map(|axis| p[axis] + scene.origin[axis])
        };
        geometry.triangles.iter().map(move |t| t.map(there))
    })
}

fn bounds(scene: &Scene) -> [[f64; 3]; 2] {
    let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    world(scene).flatten().fold(empty, |[min, max], p| {
        [[0, 1, 2].map(|a| f64::min(min[a], p[a])), [0, 1, 2].map(|a| f64::max(max[a], p[a]))]
    })
}

fn area(scene: &Scene) -> f64 {
    world(scene)
        .map(|[a, b, c]| {
            let side = |p: [f64; 3]| [0, 1, 2].map(|axis| p[axis] - a[axis]);
            let (u, v) = (side(b), side(c));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            normal.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
        })
        .sum()
}

#[test]
fn every_indexed_scene_has_the_triangles_and_the_box_that_its_index_states() {
    let Some(folder) = folder() else { return };
    let index: toml::Table = toml::from_str(&std::fs::read_to_string(folder.join("scenes.toml")).unwrap()).unwrap();
    let rows = index["scene"].as_array().unwrap();
    let entries = catalog::indexed(&folder).unwrap();
    assert_eq!(entries.len(), rows.len());
    for (entry, row) in entries.iter().zip(rows) {
        let scene = entry.load(0).unwrap();
        assert_eq!(scene.triangle_count(), entry.triangles, "{}", entry.id);
        assert!(!scene.views.is_empty() && scene.name == entry.id);
        let stated = ["bounds_min", "bounds_max"].map(|key| row[key].as_array().unwrap());
        for (found, stated) in bounds(&scene).as_flattened().iter().zip(stated.into_iter().flatten()) {
            let stated = stated.as_float().unwrap();
            // The index has four digits after the point; an instance's corner is rounded once more.
            assert!((found - stated).abs() < 2e-4, "{}: {found} is not {stated}", entry.id);
        }
    }
}

#[test]
fn every_view_is_within_reach_of_its_scene() {
    let Some(folder) = folder() else { return };
    let entries = catalog::indexed(&folder).unwrap();
    assert_eq!(entries.iter().map(|e| e.views.len()).sum::<usize>(), 39);
    for entry in entries.iter().filter(|e| e.triangles < 1_000_000) {
        let scene = entry.load(0).unwrap();
        let [min, max] = bounds(&scene);
        let length = |d: [f64; 3]| d.iter().map(|x| x * x).sum::<f64>().sqrt();
        let reach = length([0, 1, 2].map(|a| max[a] - min[a]));
        for view in &scene.views {
            let away = length([0, 1, 2].map(|a| view.eye[a] - (min[a] + max[a]) / 2.0));
            assert!(away < 2.0 * reach, "{}:{} is {away} away", entry.id, view.name);
        }
    }
}

#[test]
fn every_file_is_read_and_flat_triangles_are_kept() {
    let Some(folder) = folder() else { return };
    let files = mesh_files(&folder).unwrap();
    assert!(files.len() >= 24, "{} files", files.len());
    for file in files {
        let row = inventory(&file).unwrap();
        assert!(row.triangles > 0, "{}", file.display());
        let known = match file.file_stem().unwrap().to_str().unwrap() {
            "tower-crane" => Some(299),
            "willow-garage" => Some(248),
            "coffee-maker" => Some(60),
            _ => None,
        };
        assert!(known.is_none_or(|flat| row.zero_area == flat), "{}: {} flat", file.display(), row.zero_area);
    }
}

#[test]
fn counts_agree_with_the_files_own_headers() {
    let Some(folder) = folder() else { return };
    for file in mesh_files(&folder).unwrap() {
        let bytes = std::fs::read(&file).unwrap();
        let claimed = match file.extension().unwrap().to_ascii_lowercase().to_str() {
            Some("ply") => {
                let header = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]).into_owned();
                let line = header.lines().find_map(|l| l.strip_prefix("element face ")).unwrap().to_owned();
                line.trim().parse().unwrap()
            }
            Some("stl") if bytes[80..].first_chunk::<4>().is_some() && (bytes.len() - 84) % 50 == 0 => {
                (bytes.len() - 84) / 50
            }
            Some("stl") => String::from_utf8_lossy(&bytes).matches("endfacet").count(),
            _ => continue,
        };
        assert_eq!(read_file(&file).unwrap().triangle_count(), claimed, "{}", file.display());
    }
}

#[test]
fn the_same_part_is_the_same_in_both_formats() {
    let Some(folder) = folder() else { return };
    for (one, other) in [("featuretype.ply", "featuretype.STL"), ("building_H.obj", "building_H.gltf")] {
        let [one, other] = [one, other].map(|name| read_file(&folder.join("formats").join(name)).unwrap());
        assert_eq!(one.triangle_count(), other.triangle_count());
        assert!((area(&one) / area(&other) - 1.0).abs() < 1e-4, "{} and {}", area(&one), area(&other));
        for (a, b) in bounds(&one).as_flattened().iter().zip(bounds(&other).as_flattened()) {
            assert!((a - b).abs() < 1e-4, "{a} is not {b}");
        }
    }
}

#[test]
fn a_district_far_from_zero_keeps_its_millimetres() {
    let Some(folder) = folder() else { return };
    let path = folder.join("delft-district.obj");
    let scene = read_file(&path).unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    let vertices = text.lines().filter_map(|line| line.strip_prefix("v "));
    let mut worst = 0.0;
    for (line, read) in vertices.zip(&scene.geometries[0].positions) {
        for ((word, x), origin) in line.split_whitespace().zip(read).zip(scene.origin) {
            worst = f64::max(worst, (word.parse::<f64>().unwrap() - f64::from(*x) - origin).abs());
        }
    }
    assert!(worst > 0.0 && worst < 2e-5, "{worst}");
}

#[test]
fn characters_move() {
    let Some(folder) = folder() else { return };
    for file in ["robot.glb", "formats/Fox.glb"] {
        let rest = read_file(&folder.join(file)).unwrap();
        let moved = [0.0, 0.3, 0.6, 1e9].map(|secs| read_file_at(&folder.join(file), Some(secs)).unwrap());
        for scene in &moved {
            assert_eq!(scene.triangle_count(), rest.triangle_count());
            let [min, max] = bounds(scene);
            assert!(min.iter().chain(&max).all(|x| x.is_finite()));
            // Limbs move, but stay at the body.
            let size = |[min, max]: [[f64; 3]; 2]| (0..3).map(|a| max[a] - min[a]).fold(0.0, f64::max);
            let ratio = size([min, max]) / size(bounds(&rest));
            assert!((0.5..2.0).contains(&ratio), "{file}: {ratio}");
        }
        let corners = |scene| world(scene).collect::<Vec<_>>();
        assert_ne!(corners(&moved[1]), corners(&rest), "{file}");
        assert_ne!(corners(&moved[1]), corners(&moved[2]), "{file}");
    }
}
