//! `rdh record` and `rdh rays`.

use std::fs;
use std::path::Path;

use crate::run::{json, rdh};

fn record(folder: &Path, name: &str, more: &[&str]) -> String {
    let file = folder.join(name).to_str().unwrap().to_owned();
    let args = ["record", "tetra5", "--size", "32x32", "-o", &file];
    rdh(&[&args, more].concat()).succeeded();
    file
}

#[test]
fn a_profile_says_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let file = record(folder.path(), "a.rays", &["--mode", "whitted", "--seed", "7"]);
    let found = json(&["rays", &file, "--json"])["files"][0].take();
    assert_eq!((found["seed"].as_u64(), found["settings"]["scene"].as_str()), (Some(7), Some("tetra5")));
    let groups = found["groups"].as_array().unwrap();
    let primary = groups.iter().find(|g| g["class"] == "primary").unwrap();
    assert_eq!((primary["query"].as_str(), primary["weight"].as_u64()), (Some("closest"), Some(1024)));
    assert!(groups.iter().any(|g| g["class"] == "shadow" && g["query"] == "occluded"));
    let seen: u64 = groups.iter().map(|g| g["weight"].as_u64().unwrap()).sum();
    assert_eq!(found["seen"].as_u64(), Some(seen));
    let table = rdh(&["rays", &file]).succeeded().stdout;
    assert!(table.contains("primary") && table.contains("1024"), "{table}");
}

#[test]
fn recording_is_repeatable_and_nothing_else_is_left_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = [("a.rays", "1"), ("b.rays", "3")].map(|(name, n)| record(folder.path(), name, &["--threads", n]));
    assert_eq!(fs::read(a).unwrap(), fs::read(b).unwrap());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn thinning_is_as_if_less_had_been_kept() {
    let folder = tempfile::tempdir().unwrap();
    let large = record(folder.path(), "large.rays", &[]);
    let small = record(folder.path(), "small.rays", &["--capacity", "100"]);
    let thin = folder.path().join("thin.rays").to_str().unwrap().to_owned();
    rdh(&["rays", &large, "--thin", "100", "-o", &thin]).succeeded();
    assert_eq!(fs::read(thin).unwrap(), fs::read(small).unwrap());
}

#[test]
fn merging_a_profile_with_itself_doubles_its_weights() {
    let folder = tempfile::tempdir().unwrap();
    let file = record(folder.path(), "a.rays", &[]);
    let twice = folder.path().join("twice.rays").to_str().unwrap().to_owned();
    let found = json(&["rays", &file, &file, "--merge", "-o", &twice, "--json"])["files"][0].take();
    assert_eq!((found["samples"].as_u64(), found["seen"].as_u64()), (Some(1024), Some(2048)));
    let other = record(folder.path(), "b.rays", &["--seed", "2"]);
    rdh(&["rays", &file, &other, "--merge", "-o", &twice]).failed(1, &["seed"]);
}

#[test]
fn splitting_gives_three_sets_without_a_common_ray() {
    let folder = tempfile::tempdir().unwrap();
    let file = record(folder.path(), "a.rays", &[]);
    let out = folder.path().join("set.rays");
    rdh(&["rays", &file, "--split", "-o", out.to_str().unwrap()]).succeeded();
    let sets = ["training", "held-out", "unseen"].map(|set| out.with_extension(format!("{set}.rays")));
    let sizes =
        sets.each_ref().map(|set| json(&["rays", set.to_str().unwrap(), "--json"])["files"][0]["samples"].as_u64());
    assert_eq!(sizes.iter().flatten().sum::<u64>(), 1024);
    assert!(sizes[0].unwrap() > 400 && sizes[1].unwrap() > 150 && sizes[2].unwrap() > 150, "{sizes:?}");
    // Joined again they are the whole: no ray is in two of them, none is lost.
    let [training, held_out, unseen] = sets.each_ref().map(|set| set.to_str().unwrap());
    let joined = folder.path().join("joined.rays").to_str().unwrap().to_owned();
    let found = json(&["rays", training, held_out, unseen, "--merge", "-o", &joined, "--json"])["files"][0].take();
    assert_eq!((found["samples"].as_u64(), found["seen"].as_u64()), (Some(1024), Some(1024)));
}

#[test]
fn damaged_and_foreign_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = record(folder.path(), "a.rays", &[]);
    let mut bytes = fs::read(&file).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&file, &bytes).unwrap();
    rdh(&["rays", &file]).failed(1, &["a.rays", "byte"]);
    fs::write(&file, "no rays at all").unwrap();
    rdh(&["rays", &file]).failed(1, &["a.rays", "byte"]);
    rdh(&["rays", "no-such.rays"]).failed(1, &["no-such.rays"]);
}

#[test]
fn half_a_request_is_a_usage_error() {
    rdh(&["rays", "a.rays", "--thin", "9"]).failed(2, &["--output"]);
    rdh(&["rays"]).failed(2, &["FILE"]);
}
