//! `rdh scenes`.

use std::fs;

use serde_json::{Value, json};

use crate::run::{json, rdh};

/// Two triangles, one of them of no area.
const OBJ: &str = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 4 0 0\nf 1 2 3\nf 1 2 4\n";

#[test]
fn the_list_has_every_scene_with_its_views() {
    let list = json(&["scenes", "--json"]);
    assert_eq!(list["version"], 1);
    let scenes = list["scenes"].as_array().unwrap();
    let quick = scenes.iter().filter(|s| s["quick"] == true);
    assert!(quick.clone().count() >= 10, "the quick set has ten scenes at least");
    assert!(quick.clone().all(|s| s["views"].as_array().unwrap().len() >= 2));
    let table = rdh(&["scenes"]).succeeded().stdout;
    for scene in scenes {
        assert!(table.contains(scene["id"].as_str().unwrap()));
    }
}

#[test]
fn a_folder_adds_its_scenes() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("wedge.obj"), OBJ).unwrap();
    let index = "[[scene]]\nid = \"wedge\"\nfiles = [\"wedge.obj\"]\nformat = \"obj\"\ntriangles = 2\nup_axis = \"Z\"\n\
                 [[scene.view]]\nname = \"front\"\neye = [0, 0, 9]\ntarget = [1, 1, 0]\nup = [0, 1, 0]\nfov_y_degrees = 40\n";
    fs::write(folder.path().join("scenes.toml"), index).unwrap();
    let list = json(&["scenes", "--json", "--scenes", folder.path().to_str().unwrap()]);
    let wedge = list["scenes"].as_array().unwrap().iter().find(|s| s["id"] == "wedge").unwrap();
    assert_eq!((&wedge["embedded"], &wedge["views"][0]["name"]), (&json!(false), &json!("front")));
    let rows =
        json(&["compare", "wedge:front", "--scenes", folder.path().to_str().unwrap(), "--json", "--size", "8x8"]);
    assert_eq!(rows["rows"][0]["triangles"], 2);
}

#[test]
fn a_file_is_told_in_full() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wedge.obj");
    fs::write(&file, OBJ).unwrap();
    let found = json(&["scenes", "--json", file.to_str().unwrap()]);
    let wedge = &found["files"][0];
    let numbers = ["geometries", "instances", "triangles", "unique_triangles", "zero_area"];
    assert_eq!(numbers.map(|name| wedge[name].clone()), [1, 1, 2, 2, 1].map(Value::from));
    assert_eq!((&wedge["bounds_min"], &wedge["bounds_max"]), (&json!([0.0, 0.0, 0.0]), &json!([4.0, 3.0, 0.0])));
    assert!(wedge["secs"].as_f64().unwrap() >= 0.0);
}

#[test]
fn a_broken_file_is_named_with_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.obj");
    fs::write(&file, "v 0 0 0\nv 1 0 zero\nf 1 2 3\n").unwrap();
    rdh(&["scenes", file.to_str().unwrap()]).failed(1, &["broken.obj", "line 2"]);
    assert_eq!(rdh(&["compare", file.to_str().unwrap(), "--size", "8x8", "--json"]).code, Some(1));
}
