//! `rdh build` and `rdh verify`, and saved trees where scenes are.

use std::fs;
use std::path::Path;

use xxhash_rust::xxh3::xxh3_64;

use crate::run::{json, rdh};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

fn record(folder: &Path) -> String {
    let file = path(folder, "a.rays");
    rdh(&["record", "rooms", "--mode", "path", "--size", "40x40", "-o", &file]).succeeded();
    file
}

fn build(folder: &Path, name: &str, more: &[&str]) -> String {
    let file = path(folder, name);
    rdh(&[&["build", "rooms", "-o", &file], more].concat()).succeeded();
    file
}

#[test]
fn a_tree_for_rays_is_proved_by_those_that_it_has_not_seen() {
    let folder = tempfile::tempdir().unwrap();
    let rays = record(folder.path());
    let tree = path(folder.path(), "a.rdh");
    let built = json(&["build", "rooms", "--rays", &rays, "--seed", "5", "-o", &tree, "--json"]);
    assert_eq!((built["spec"].as_str(), built["scene"].as_str()), (Some("bvh8+rdh"), Some("rooms")));
    let samples = json(&["rays", &rays, "--json"])["files"][0]["samples"].as_u64().unwrap();
    let [trained, unseen] = ["trained_on", "unseen_rays"].map(|key| built[key].as_u64().unwrap());
    assert!(trained > 2 * samples / 5 && unseen > samples / 5 && trained + unseen < samples, "{built}");
    let proved = json(&["verify", &tree, "--samples", "40", "--counts-only", "--json"]);
    assert_eq!((proved["ok"].as_bool(), proved["brute_force"]["different"].as_u64()), (Some(true), Some(0)));
    let race = &proved["races"][0];
    assert_eq!((race["base"].as_str(), race["found"]["rays"].as_u64()), (Some("bvh8+sah"), Some(unseen)));
    assert!(race["found"]["counts"]["ratio"].as_f64().unwrap() < 1.0 && race["found"]["time"].is_null(), "{race}");
    // The same rays again, out of their file: the tree's own seed tells which they are.
    let again = json(&["verify", &tree, "--samples", "40", "--rays", &rays, "--counts-only", "--json"]);
    assert_eq!(again["races"], proved["races"]);
    let timed = json(&["verify", &tree, "--samples", "40", "--rounds", "3", "--margin", "1", "--json"]);
    assert!(timed["races"][0]["found"]["time"]["ratio"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_same_seed_gives_the_same_file_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let rays = record(folder.path());
    let [a, b] = [("a.rdh", "1"), ("b.rdh", "3")]
        .map(|(name, threads)| build(folder.path(), name, &["--rays", &rays, "--threads", threads]));
    assert!(fs::read(a).unwrap() == fs::read(b).unwrap());
}

#[test]
fn a_slower_tree_is_refused_with_exit_code_3() {
    let folder = tempfile::tempdir().unwrap();
    let rays = record(folder.path());
    let tree = build(folder.path(), "a.rdh", &["--spec", "kd+sah", "--rays", &rays]);
    rdh(&["verify", &tree, "--samples", "40", "--counts-only"]).succeeded();
    let ran = rdh(&["verify", &tree, "--samples", "40", "--counts-only", "--base", "kd+sah,bvh8+sah"]);
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    assert!(
        ran.stderr.contains("slower than bvh8+sah") && ran.stdout.contains("slower than bvh8+sah"),
        "{}",
        ran.stdout
    );
}

#[test]
fn a_tuned_tree_is_proved_by_its_own_rays_against_the_best_by_areas() {
    let folder = tempfile::tempdir().unwrap();
    let tree = path(folder.path(), "t.rdh");
    let args = ["tune", "rooms", "--size", "48x48", "--candidates", "kd+sah,bvh8+sah,bvh8+rdh", "--counts-only"];
    let tuned = json(&[&args[..], &["-o", &tree, "--json"]].concat())["cases"][0]["evidence"].take();
    let proved = json(&["verify", &tree, "--samples", "40", "--counts-only", "--json"]);
    assert_eq!((&proved["spec"], proved["ok"].as_bool()), (&tuned["spec"], Some(true)));
    match proved["races"].as_array().unwrap().as_slice() {
        [] => assert_eq!(tuned["spec"], tuned["base"]),
        [race] => assert_eq!(race["base"], tuned["base"]),
        _ => panic!("{proved}"),
    }
}

/// Shrinks the box of the first leaf to a point and signs the file again: rays miss what is in it.
fn break_tree(file: &str) {
    let mut bytes = fs::read(file).unwrap();
    let word = |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let is_nodes = |row: &usize| word(&bytes, *row) == 5;
    let nodes = word(&bytes, (64..).step_by(32).find(is_nodes).unwrap() + 8) as usize;
    // Nodes of eight: lower and upper planes on three axes, then what lies in the boxes.
    let leaf = |at: &usize| word(&bytes, nodes + at / 8 * 256 + 192 + at % 8 * 4) >> 31 == 1;
    let leaf = (0..).find(leaf).unwrap();
    for axis in 0..3 {
        let lower = nodes + leaf / 8 * 256 + axis * 32 + leaf % 8 * 4;
        bytes.copy_within(lower + 96..lower + 100, lower);
    }
    let checksum = xxh3_64(&bytes[24..]);
    bytes[16..24].copy_from_slice(&checksum.to_le_bytes());
    fs::write(file, bytes).unwrap();
}

#[test]
fn a_broken_tree_is_refused_with_exit_code_3_and_an_altered_file_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let tree = build(folder.path(), "a.rdh", &[]);
    rdh(&["verify", &tree, "--samples", "40"]).succeeded();
    break_tree(&tree);
    let ran = rdh(&["verify", &tree, "--samples", "40", "--json"]);
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!((found["ok"].as_bool(), found["brute_force"].is_null()), (Some(false), true));
    assert!(found["faults"][0].as_str().unwrap().contains("is not held"), "{found}");
    let mut bytes = fs::read(&tree).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&tree, &bytes).unwrap();
    rdh(&["verify", &tree, "--samples", "40"]).failed(1, &["a.rdh", "byte 16", "checksum"]);
    rdh(&["cast", &tree, "--rays", "x.npy", "-o", "y.npy"]).failed(1, &["a.rdh", "byte 16"]);
    fs::write(&tree, &bytes[..1000]).unwrap();
    rdh(&["scenes", &tree]).failed(1, &["a.rdh", "byte 1000"]);
}

#[test]
fn a_saved_tree_is_a_scene_with_its_views() {
    let folder = tempfile::tempdir().unwrap();
    let tree = build(folder.path(), "a.rdh", &[]);
    let picture = path(folder.path(), "a.png");
    let views = json(&["scenes", "--json"])["scenes"].take();
    let rooms = views.as_array().unwrap().iter().find(|s| s["id"] == "rooms").unwrap().clone();
    let view = rooms["views"][0]["name"].as_str().unwrap();
    rdh(&["render", &format!("{tree}:{view}"), "--size", "16x16", "-o", &picture]).succeeded();
    let again = build(folder.path(), "b.rdh", &[]);
    // A tree built over a saved tree's mesh is the same tree.
    let of_tree = json(&["build", &tree, "-o", &again, "--json"]);
    assert_eq!(of_tree["triangles"], rooms["triangles"]);
    let fingerprint =
        |file: &str| json(&["build", file, "-o", &path(folder.path(), "c.rdh"), "--json"])["fingerprint"].take();
    assert_eq!(fingerprint(&tree), fingerprint("rooms"));
}

#[test]
fn what_makes_no_sense_is_a_usage_error() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "a.rdh");
    rdh(&["build", "rooms", "--spec", "bvh8+rdh", "-o", &out]).failed(2, &["--rays"]);
    rdh(&["build", "rooms", "--spec", "bvh9", "-o", &out]).failed(2, &["bvh9", "bvh8"]);
    rdh(&["build", "rooms"]).failed(2, &["--output"]);
    let rays = record(folder.path());
    let sets = path(folder.path(), "s.rays");
    rdh(&["rays", &rays, "--split", "-o", &sets]).succeeded();
    let set = |name: &str| path(folder.path(), &format!("s.{name}.rays"));
    rdh(&["build", "rooms", "--rays", &set("unseen"), "-o", &out]).failed(2, &["unseen", "not for building"]);
    rdh(&["build", "rooms", "--rays", &set("training"), "-o", &out]).succeeded();
    rdh(&["verify", &out, "--rays", &set("training")]).failed(2, &["does not judge"]);
    rdh(&["verify", &out, "--samples", "40", "--rays", &set("unseen"), "--counts-only"]).succeeded();
    rdh(&["verify", &out, "--base", "kd+rdh"]).failed(2, &["by areas"]);
    rdh(&["build", "rooms", "-o", "no-such-folder/a.rdh"]).failed(1, &["no-such-folder"]);
}
