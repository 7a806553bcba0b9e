//! The embedded scenes are what their TOMLs and `golden.toml` say, and texts lead to the right ones.

use std::collections::{BTreeMap, BTreeSet};

use rdh::{BuildOptions, Spec, Training};
use rdh_scene::catalog::{embedded, find, split_view};
use rdh_scene::{Camera, Entry, Kind, Scene, Source};
use serde::{Deserialize, Serialize};

/// What a scene was when it was last looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Golden {
    triangles: usize,
    /// Its box, relative to the scene's origin.
    min: [f32; 3],
    max: [f32; 3],
    /// The share of each view's rays that hit, at 64 × 64 pixels' centres.
    hits: BTreeMap<String, f64>,
}

/// Above this, tracing takes too long for a test that runs always.
const TRACED: usize = 250_000;
const PIXELS: u32 = 64;

fn golden_path() -> &'static str {
    concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden.toml")
}

/// `RDH_GOLDEN=write` writes the file anew, tracing all scenes; else small ones are compared whole, large ones by their
/// counts and boxes.
#[test]
fn embedded_scenes_are_the_golden_ones() {
    let write = std::env::var("RDH_GOLDEN").is_ok_and(|v| v == "write");
    let known: BTreeMap<String, Golden> =
        if write { BTreeMap::new() } else { toml::from_str(&std::fs::read_to_string(golden_path()).unwrap()).unwrap() };
    let mut now = BTreeMap::new();
    for entry in embedded().unwrap() {
        let scene = entry.load(0).unwrap();
        let mut golden = measure(&entry, &scene, write || entry.triangles <= TRACED);
        if !write {
            let expected = known.get(&entry.id).unwrap_or_else(|| panic!("{} is not in golden.toml", entry.id));
            assert_eq!(entry.triangles, expected.triangles, "{}: triangles in its TOML", entry.id);
            compare(&entry.id, &golden, expected);
        }
        golden.hits.values_mut().for_each(|share| *share = (*share * 1e4).round() / 1e4);
        now.insert(entry.id, golden);
    }
    if write {
        std::fs::write(golden_path(), toml::to_string(&now).unwrap()).unwrap();
    } else {
        assert_eq!(now.keys().collect::<Vec<_>>(), known.keys().collect::<Vec<_>>());
    }
}

fn compare(id: &str, got: &Golden, expected: &Golden) {
    assert_eq!(got.triangles, expected.triangles, "{id}");
    let size = (0..3).map(|a| expected.max[a] - expected.min[a]).fold(0.0, f32::max);
    for (got, expected) in got.min.iter().chain(&got.max).zip(expected.min.iter().chain(&expected.max)) {
        // Sines may differ in their last bit between platforms.
        assert!((got - expected).abs() <= 1e-5 * size, "{id}: {got}, not {expected}");
    }
    for (view, share) in &got.hits {
        let expected = expected.hits.get(view).unwrap_or_else(|| panic!("{id}:{view} is not in golden.toml"));
        assert!((share - expected).abs() < 0.003, "{id}:{view}: {share} of the rays hit, not {expected}");
    }
}

fn measure(entry: &Entry, scene: &Scene, trace: bool) -> Golden {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for instance in &scene.instances {
        for p in &scene.geometries[instance.geometry].positions {
            let p = instance.scene_from_object.point(p.map(f64::from)).map(|x| x as f32);
            (min, max) = ([0, 1, 2].map(|a| p[a].min(min[a])), [0, 1, 2].map(|a| p[a].max(max[a])));
        }
    }
    let hits = if trace { hit_shares(entry, scene) } else { BTreeMap::new() };
    Golden { triangles: scene.triangle_count(), min, max, hits }
}

fn hit_shares(entry: &Entry, scene: &Scene) -> BTreeMap<String, f64> {
    let mesh = scene.flatten().unwrap().mesh;
    let accel = rdh::build(&mesh, &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
    let share = |camera: Camera| {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(PIXELS);
        let pixels = (0..PIXELS).flat_map(|y| (0..PIXELS).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| accel.closest(&camera.ray(at(x), at(y))).is_some()).count() as f64
            / f64::from(PIXELS * PIXELS)
    };
    entry.views.iter().map(|view| (view.name.clone(), share(Camera::new(view, scene.origin, 1.0)))).collect()
}

/// Havran (1999) gives the share of 513 × 513 eye rays that hit at the default sizes.
#[test]
fn hit_shares_are_the_published_ones() {
    let total = 513.0 * 513.0;
    for (id, hits) in [
        ("balls4", 263_169.0),
        ("gears4", 245_332.0),
        ("lattice12", 261_170.0),
        ("mount6", 173_685.0),
        ("rings7", 263_169.0),
        ("teapot12", 161_546.0),
        ("tetra6", 49_950.0),
        ("tree11", 169_907.0),
    ] {
        let entry = find(id, &[]).unwrap();
        let share = hit_shares(&entry, &entry.load(0).unwrap())["given"];
        // 64 × 64 samples, and chords instead of circles.
        assert!((share - hits / total).abs() < 0.01, "{id}: {share}, published {}", hits / total);
    }
}

#[test]
fn every_view_shows_something() {
    let text = std::fs::read_to_string(golden_path()).unwrap();
    let golden: BTreeMap<String, Golden> = toml::from_str(&text).unwrap();
    for entry in embedded().unwrap() {
        for view in &entry.views {
            let share = golden[&entry.id].hits[&view.name];
            assert!(share > 0.15, "{}:{}: {share}", entry.id, view.name);
        }
    }
}

#[test]
fn the_catalogue_is_large_and_mixed() {
    let entries = embedded().unwrap();
    let views: usize = entries.iter().map(|e| e.views.len()).sum();
    assert!(entries.len() >= 36 && views >= 60, "{} scenes, {views} views", entries.len());
    let ids: BTreeSet<&str> = entries.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(ids.len(), entries.len());
    for (family, sizes) in [
        ("balls", [3, 4, 5]),
        ("gears", [2, 4, 9]),
        ("jacks", [3, 4, 5]),
        ("lattice", [6, 12, 29]),
        ("mount", [4, 6, 8]),
        ("rings", [3, 7, 17]),
        ("sombrero", [1, 2, 4]),
        ("teapot", [4, 12, 40]),
        ("tetra", [5, 6, 8]),
        ("tree", [8, 11, 15]),
    ] {
        assert!(sizes.iter().all(|size| ids.contains(format!("{family}{size}").as_str())), "{family}");
    }
    for entry in &entries {
        let names: BTreeSet<&str> = entry.views.iter().map(|v| v.name.as_str()).collect();
        assert!(names.len() == entry.views.len() && names.len() >= 2, "{}: {names:?}", entry.id);
        assert!(!entry.about.is_empty() && entry.frames >= 1);
    }
}

#[test]
fn the_quick_set_is_small_and_mixed() {
    let quick: Vec<Entry> = embedded().unwrap().into_iter().filter(|e| e.quick).collect();
    assert!(quick.len() >= 10);
    assert!(quick.iter().all(|e| e.triangles <= 150_000));
    for kind in [Kind::Open, Kind::Interior, Kind::Dense] {
        assert!(quick.iter().any(|e| e.kind == kind), "{kind:?}");
    }
    for generator in ["building", "city", "forest", "terrain"] {
        let made_by =
            |e: &Entry| matches!(&e.source, Source::Generator(t) if t["generator"].as_str() == Some(generator));
        assert!(quick.iter().any(made_by), "{generator}");
    }
}

#[test]
fn frames_move_and_end() {
    let entry = find("traffic", &[]).unwrap();
    assert!(entry.frames >= 8);
    let (first, last) = (entry.load(0).unwrap(), entry.load(entry.frames - 1).unwrap());
    assert_eq!(first.triangle_count(), last.triangle_count());
    assert_ne!(first.instances, last.instances);
}

#[test]
fn paths_lead_through_scenes() {
    for (id, name) in [("building", "walk"), ("city", "drive"), ("forest", "walk"), ("terrain", "flight")] {
        let entry = find(id, &[]).unwrap();
        let paths = entry.paths().unwrap();
        let path = paths.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("{id} has no path {name}"));
        let (first, last) = (path.at(0).unwrap(), path.at(path.frames - 1).unwrap());
        assert_ne!(first.eye, last.eye);
        let end = path.views.last().unwrap().eye;
        assert!(last.eye.iter().zip(end).all(|(a, b)| (a - b).abs() < 1e-9), "{id}: {:?}, not {end:?}", last.eye);
    }
    assert!(find("balls3", &[]).unwrap().paths().unwrap().is_empty());
}

#[test]
fn generators_are_found_with_parameters() {
    let entry = find("balls(size=2,resolution=8)", &[]).unwrap();
    assert_eq!(entry.triangles, 91 * 512 + 2);
    assert_eq!(entry.id, "balls(resolution=8,size=2)");
    assert_eq!(find(&entry.id, &[]).unwrap().triangles, entry.triangles);
    assert_eq!(entry.views, find("balls3", &[]).unwrap().views);
    let rooms = find("building(rooms_x=1,rooms_y=1,floors=1,seed=3)", &[]).unwrap();
    assert_eq!(rooms.load(0).unwrap().triangle_count(), rooms.triangles);
    // An embedded scene with other parameters.
    assert_eq!(find("balls3(resolution=1)", &[]).unwrap().triangles, 820 * 8 + 2);
    assert!(find("balls(size=99)", &[]).is_err());
}

#[test]
fn unknown_scenes_are_answered_with_near_names() {
    for (text, near) in [("bals4", "balls4"), ("Teapot", "teapot12"), ("buildng", "building"), ("rooms2", "rooms")] {
        let error = find(text, &[]).unwrap_err().to_string();
        assert!(error.contains(near), "{error}");
    }
    assert!(find("xyzzy-plugh-nothing", &[]).unwrap_err().to_string().contains("rdh scenes"));
    assert!(find("no/such/file.obj", &[]).unwrap_err().to_string().contains("no such file"));
}

#[test]
fn extra_entries_and_files_are_found() {
    let mut extra = find("balls3", &[]).unwrap();
    extra.id = "country-kitchen".to_owned();
    assert_eq!(find("country-kitchen", &[extra]).unwrap().triangles, 26_242);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.obj");
    std::fs::write(&path, "v 0 0 0\nv 4 0 0\nv 4 2 0\nv 0 2 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\n").unwrap();
    let entry = find(path.to_str().unwrap(), &[]).unwrap();
    assert_eq!(entry.triangles, 3);
    let names: Vec<&str> = entry.views.iter().map(|v| v.name.as_str()).collect();
    assert_eq!(names, ["front", "oblique", "inside"]);
    assert_eq!(entry.load(0).unwrap().triangle_count(), 3);
}

#[test]
fn views_are_split_from_scenes() {
    for (text, scene, view) in [
        ("country-kitchen:table", "country-kitchen", Some("table")),
        ("balls(size=3):given", "balls(size=3)", Some("given")),
        ("balls4", "balls4", None),
        ("balls4:", "balls4:", None),
        (r"C:\models\box.obj", r"C:\models\box.obj", None),
        ("C:/models/box.obj", "C:/models/box.obj", None),
        (r"C:\models\box.obj:front", r"C:\models\box.obj", Some("front")),
        ("models/box.obj:front", "models/box.obj", Some("front")),
    ] {
        assert_eq!(split_view(text), (scene, view), "{text}");
    }
}
