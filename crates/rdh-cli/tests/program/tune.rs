//! `rdh tune`, `auto`, and drift.

use std::fs;

use serde_json::Value;

use crate::run::{json, rdh};

const SMALL: [&str; 2] = ["--size", "64x64"];
const FEW: &str = "bvh8+sah,kd+sah,bvh8+rdh";

#[test]
fn the_evidence_says_what_was_tried_and_why_one_was_taken() {
    let args = ["tune", "rooms:corridor", "--counts-only", "--candidates", FEW];
    let found = json(&[&args[..], &SMALL, &["--json"]].concat());
    let case = &found["cases"][0];
    let evidence = &case["evidence"];
    assert_eq!((&found["version"], found["cases"].as_array().unwrap().len()), (&Value::from(1), 1));
    assert_eq!(
        (&case["scene"], &case["view"], &case["rays"]),
        (&"rooms".into(), &"corridor".into(), &"primary".into())
    );
    let tried: Vec<_> = evidence["trials"].as_array().unwrap().iter().map(|t| t["spec"].as_str().unwrap()).collect();
    assert_eq!(tried.join(","), FEW);
    // A corridor in a house of rooms: what is behind walls is what areas pay for.
    assert_eq!(
        (&evidence["spec"], &evidence["outcome"], &evidence["measure"]),
        (&"bvh8+rdh".into(), &"rays".into(), &"counts".into())
    );
    assert!(case["unseen"]["counts"]["ratio"].as_f64().unwrap() < 1.0 && case["slower"] == false, "{case}");
    let again = json(&[&args[..], &SMALL, &["--json", "--threads", "1"]].concat());
    assert_eq!(found, again);
    let table = rdh(&[&args[..], &SMALL].concat()).succeeded().stdout;
    for word in ["bvh8+rdh takes", "best by areas", "taken", "unseen rays"] {
        assert!(table.contains(word), "no '{word}' in {table}");
    }
}

#[test]
fn many_cases_are_a_line_each() {
    let table = rdh(&["tune", "tetra5", "--mode", "primary,ao", "--candidates", FEW, "--size", "64x64"]);
    let table = table.succeeded().stdout;
    assert!(table.contains("ao") && table.contains("4 cases") && table.contains("0 surely slower"), "{table}");
}

#[test]
fn a_structure_is_kept_with_its_evidence() {
    let folder = tempfile::tempdir().unwrap();
    let [rays, tree] = ["a.rays", "a.rdh"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    rdh(&["record", "rooms", "--size", "64x64", "-o", &rays]).succeeded();
    let found = json(&["tune", "rooms", "--rays", &rays, "--counts-only", "--candidates", FEW, "-o", &tree, "--json"]);
    let accel = rdh::Accel::from_bytes(&fs::read(&tree).unwrap()).unwrap();
    let kept = accel.provenance();
    assert_eq!(kept.evidence.as_ref(), Some(&found["cases"][0]["evidence"]));
    assert_eq!((kept.seed, &kept.settings["scene"]["id"]), (Some(1), &"rooms".into()));
    assert_eq!(found["cases"][0]["evidence"]["spec"], accel.stats().spec.to_string());
}

#[test]
fn too_few_rays_are_said_and_areas_kept() {
    let folder = tempfile::tempdir().unwrap();
    let rays = folder.path().join("a.rays").to_str().unwrap().to_owned();
    rdh(&["record", "tetra5", "--size", "8x8", "-o", &rays]).succeeded();
    let table = rdh(&["tune", "tetra5", "--rays", &rays]).succeeded().stdout;
    assert!(table.contains("too few held-out rays") && table.contains("bvh8+sah is kept"), "{table}");
}

#[test]
fn auto_names_what_it_chose() {
    let args = [
        "compare",
        "rooms:corridor",
        "--spec",
        "bvh8+sah,auto",
        "--size",
        "64x64",
        "--rounds",
        "1",
        "--training",
        "2000",
    ];
    let document = json(&[&args[..], &["--json"]].concat());
    let row = document["rows"].as_array().unwrap().iter().find(|r| r["spec"] == "auto").unwrap();
    let chosen = row["chosen"].as_str().unwrap();
    assert!(chosen.contains("rdh"), "{chosen}");
    assert_eq!(document["summary"][0]["spec"], "auto");
    let table = rdh(&args).succeeded().stdout;
    assert!(table.contains(&format!("auto: {chosen}")), "{table}");
}

#[test]
fn a_moved_camera_drifts() {
    let folder = tempfile::tempdir().unwrap();
    let record = |name: &str, view: &str, seed: &str| {
        let file = folder.path().join(name).to_str().unwrap().to_owned();
        rdh(&["record", view, "--size", "64x64", "--seed", seed, "-o", &file]).succeeded();
        file
    };
    let [base, same] = [record("a.rays", "rooms:corridor", "1"), record("b.rays", "rooms:corridor", "2")];
    let other = record("c.rays", "rooms:outside", "1");
    let found = json(&["rays", &same, &other, "--drift", &base, "--json"]);
    let drifts = found["drifts"].as_array().unwrap();
    let drift = |i: usize| [drifts[i]["drift"].as_f64().unwrap(), drifts[i]["p_value"].as_f64().unwrap()];
    assert!(drift(0)[0] < 0.1 && drift(0)[1] > 0.01, "{drifts:?}");
    assert!(drift(1)[0] > 0.3 && drift(1)[1] < 0.01, "{drifts:?}");
    let table = rdh(&["rays", &same, &other, "--drift", &base]).succeeded().stdout;
    assert!(table.contains("no clear difference") && table.contains("other rays"), "{table}");
}

#[test]
fn requests_without_sense_are_usage_errors() {
    rdh(&["tune", "tetra5", "--candidates", "kd+sah,what"]).failed(2, &["what"]);
    rdh(&["tune", "tetra5", "--weights", "shade=1"]).failed(2, &["shade=1", "classes: primary"]);
    rdh(&["tune", "tetra5", "balls3", "-o", "a.rdh"]).failed(2, &["one scene"]);
    rdh(&["tune", "tetra5", "--candidates", "kd+rdh"]).failed(2, &["needs no rays"]);
    rdh(&["tune", "tetra5", "--candidates", "kd+sah,auto"]).failed(2, &["'auto'"]);
    rdh(&["tune", "tetra5", "--rays", "no-such.rays"]).failed(1, &["no-such.rays"]);
    rdh(&["tune", "tetra5", "--list"]).failed(2, &["--list"]);
    let list = rdh(&["tune", "--list"]).succeeded().stdout;
    assert!(list.contains("bvh8(high)+rdh") && list.lines().count() >= 8, "{list}");
    let listed = json(&["tune", "--list", "--json"]);
    assert_eq!(listed["candidates"].as_array().unwrap().len(), list.lines().count());
}

#[test]
fn rays_of_another_scene_and_parts_of_a_split_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let [rays, sets] = ["a.rays", "s.rays"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    rdh(&["record", "tetra5", "--size", "32x32", "-o", &rays]).succeeded();
    let ran = rdh(&["tune", "balls3", "--rays", &rays, "--counts-only", "--candidates", "bvh8+sah"]).succeeded();
    assert!(ran.stderr.contains("recorded in tetra5, not in balls3"), "{}", ran.stderr);
    let ran = rdh(&["tune", "tetra5", "--rays", &rays, "--counts-only", "--candidates", "bvh8+sah"]).succeeded();
    assert_eq!(ran.stderr, "");
    rdh(&["rays", &rays, "--split", "-o", &sets]).succeeded();
    let unseen = folder.path().join("s.unseen.rays").to_str().unwrap().to_owned();
    rdh(&["tune", "tetra5", "--rays", &unseen]).failed(2, &["the unseen set of a split"]);
}

#[test]
fn a_saved_tree_knows_how_far_rays_have_drifted() {
    let folder = tempfile::tempdir().unwrap();
    let [here, there, tree] =
        ["here.rays", "there.rays", "a.rdh"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    rdh(&["record", "flat:room", "--size", "64x64", "-o", &here]).succeeded();
    rdh(&["record", "flat:outside", "--size", "64x64", "-o", &there]).succeeded();
    rdh(&["tune", "flat", "--rays", &here, "--counts-only", "--candidates", FEW, "-o", &tree]).succeeded();
    let drift = |rays: &str| {
        let found =
            json(&["verify", &tree, "--rays", rays, "--samples", "40", "--counts-only", "--margin", "1", "--json"]);
        let by_rays = json(&["rays", rays, "--drift", &tree, "--json"])["drifts"][0]["p_value"].as_f64().unwrap();
        (found["drift"]["drift"].as_f64().unwrap(), by_rays)
    };
    let (near, far) = (drift(&here), drift(&there));
    assert!(near.0 < 0.1 && near.1 > 0.01 && far.0 > 0.3 && far.1 < 0.01, "{near:?} {far:?}");
    let said =
        rdh(&["verify", &tree, "--rays", &there, "--samples", "40", "--counts-only", "--margin", "1"]).succeeded();
    assert!(said.stdout.contains("that it was made for: other rays"), "{}", said.stdout);
    let bare = folder.path().join("bare.rdh").to_str().unwrap().to_owned();
    rdh(&["build", "flat", "-o", &bare]).succeeded();
    rdh(&["rays", &here, "--drift", &bare]).failed(1, &["bare.rdh", "holds no rays"]);
}
