//! `rdh bench`. How engines are raced is tested in the study crate; here nothing but ours is there.

use serde_json::Value;

use crate::run::{json, rdh};

/// A small race without competitors: the folder of engines is empty.
fn small(folder: &tempfile::TempDir, args: &[&str]) -> Vec<String> {
    let mut all: Vec<String> = ["bench", "tetra5", "--size", "16x16", "--rounds", "2"].map(String::from).to_vec();
    if !args.contains(&"--engine-dir") {
        all.extend(["--engine-dir".to_owned(), folder.path().display().to_string()]);
    }
    all.extend(args.iter().map(|arg| (*arg).to_owned()));
    all
}

fn texts(args: &[String]) -> Vec<&str> {
    args.iter().map(String::as_str).collect()
}

#[test]
fn json_has_the_rows_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let args = small(&folder, &["--json", "--specs", "bvh8+sah,kd+sah", "--columns", "rows,tiles,bounce,ao"]);
    let document = json(&texts(&args));
    let rows = document["rows"].as_array().unwrap();
    assert_eq!((&document["version"], rows.len()), (&Value::from(1), 4 * 4));
    let names = ["scene", "view", "column", "engine", "form", "profile"];
    let numbers =
        ["rays", "hits", "t_sum", "mrays_per_sec", "mrays_per_sec_best", "build_secs", "bytes", "triangles", "lost"];
    for row in rows {
        assert!(names.iter().all(|name| row[name].is_string()), "{row}");
        assert!(numbers.iter().all(|name| row[name].is_number()), "{row}");
        assert_eq!(row["agrees"], true);
    }
    assert_eq!(
        (&rows[0]["rays"], &rows[0]["column"], &rows[0]["engine"]),
        (&256.into(), &"rows".into(), &"bvh8+sah".into())
    );
    assert!(document["summary"].as_array().unwrap().is_empty());
    assert_eq!(document["builds"].as_array().unwrap().len(), 2);
}

#[test]
fn instructions_race_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let args = small(&folder, &["--json", "--specs", "bvh8+sah", "--columns", "rows", "--levels", "portable"]);
    let document = json(&texts(&args));
    let engines = document["rows"].as_array().unwrap().iter().map(|row| row["engine"].as_str().unwrap());
    assert_eq!(engines.collect::<Vec<_>>(), ["bvh8+sah on portable", "batch(bvh8+sah on portable)"]);
    assert_eq!(document["settings"]["levels"][0], "portable");
}

#[test]
fn competitors_that_are_not_there_are_skipped_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let args = small(&folder, &["--specs", "bvh8+sah", "--engines", "embree4,obvhs", "--columns", "rows"]);
    let ran = rdh(&texts(&args)).succeeded();
    for word in ["skipped: embree4: ", "skipped: obvhs: ", "bvh8+sah", "tetra5:", "Mrays/s", "16 x 16"] {
        assert!(ran.stdout.contains(word), "no '{word}' in:\n{}", ran.stdout);
    }
    assert!(!ran.stdout.contains("parry3d"));
    let args = small(&folder, &["--specs", "bvh8+sah", "--engines", "none", "--columns", "rows"]);
    let alone = rdh(&texts(&args)).succeeded();
    assert!(!alone.stdout.contains("skipped") && alone.stderr.is_empty(), "{}{}", alone.stdout, alone.stderr);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let failed = |args: &[&str], code, words: &[&str]| rdh(&texts(&small(&folder, args))).failed(code, words);
    failed(&["--engines", "embree5"], 2, &["embree5", "embree4-robust", "obvhs"]);
    failed(&["--columns", "columns"], 2, &["columns", "rows, tiles, shadow, bounce, ao, shuffled"]);
    failed(&["--specs", "bvh8+sah,bvh8+sah"], 2, &["twice"]);
    failed(&["--specs", "bvh9+sah"], 2, &["bvh9"]);
    failed(&["--levels", "mmx"], 2, &["mmx", "this CPU has portable"]);
    failed(&["--levels", "portable,portable"], 2, &["portable", "twice"]);
    failed(&["--tolerance", "101"], 2, &["share of hits"]);
    failed(&["--engine-dir", "no/such/folder"], 1, &["no/such/folder"]);
    rdh(&["bench", "--size", "64x32"]).failed(2, &["square"]);
}

#[test]
fn a_race_goes_on_from_its_file_and_refuses_that_of_another() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("race.log").display().to_string();
    let args = small(&folder, &["--json", "--specs", "bvh8+sah", "--columns", "rows,ao", "--out", &file]);
    let (first, again) = (json(&texts(&args)), json(&texts(&args)));
    assert_eq!(first["rows"], again["rows"]);
    assert_eq!(std::fs::read_to_string(&file).unwrap().lines().count(), 3);
    let other = small(&folder, &["--json", "--specs", "kd+sah", "--columns", "rows,ao", "--out", &file]);
    rdh(&texts(&other)).failed(1, &["race.log", "other settings"]);
}

#[test]
fn builds_are_measured_on_one_thread_and_two() {
    let args = ["bench", "--builds", "tetra5", "--rounds", "1", "--specs", "bvh8+sah,kd+sah"];
    let document = json(&[&args[..], &["--json"]].concat());
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        let numbers = ["triangles", "cpu_secs", "one_thread_secs", "two_threads_secs", "references", "bytes"];
        assert!(numbers.iter().all(|name| row[name].as_f64().unwrap() > 0.0), "{row}");
        assert_eq!((&row["scene"], &row["same_trees"]), (&"tetra5".into(), &true.into()));
    }
    assert!(document["ceiling"].as_f64().unwrap() > 0.0);
    let ran = rdh(&["bench", "--builds", "tetra5", "--specs", "kd+rdh"]);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert!(ran.stderr.contains("needs rays"), "{}", ran.stderr);
}
