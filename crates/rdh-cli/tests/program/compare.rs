//! `rdh compare`.

use serde_json::Value;

use crate::run::{json, rdh};

const SMALL: [&str; 6] = ["--size", "32x32", "--rounds", "1", "--training", "512"];

fn small(args: &[&'static str]) -> Vec<&'static str> {
    ["compare"].iter().chain(args).chain(&SMALL).copied().collect()
}

#[test]
fn json_has_the_rows_of_the_contract() {
    let document = json(&small(&["sombrero1", "--json"]));
    let rows = document["rows"].as_array().unwrap();
    let views: std::collections::BTreeSet<_> = rows.iter().map(|r| r["view"].as_str().unwrap()).collect();
    assert_eq!((&document["version"], rows.len()), (&Value::from(1), 3 * views.len()));
    let texts = ["scene", "view", "mode", "class", "spec"];
    let numbers = [
        "frame",
        "triangles",
        "rays",
        "hits",
        "t_sum",
        "trained_on",
        "steps_per_ray",
        "tests_per_ray",
        "empty_leaves_per_ray",
        "nanos_per_ray",
        "build_secs",
        "rrs_secs",
        "nodes",
        "references",
        "bytes",
        "seed",
    ];
    for row in rows {
        assert!(texts.iter().all(|name| row[name].is_string()), "{row}");
        assert!(numbers.iter().all(|name| row[name].is_number()), "{row}");
        assert_eq!((row["rays"].as_u64(), row["seed"].as_u64()), (Some(1024), Some(1)));
        // The same answers from every structure.
        let base = rows.iter().find(|base| base["view"] == row["view"]).unwrap();
        assert_eq!((&row["hits"], &row["t_sum"]), (&base["hits"], &base["t_sum"]));
    }
    assert_eq!(rows[0]["spec"], "kd+sah");
    assert_eq!(rows[2]["trained_on"], 512);
}

#[test]
fn the_summary_is_against_the_first_spec() {
    let document = json(&small(&["sombrero1", "tetra5", "--json", "--spec", "kd+rdh,kd+sah,kd(prune=none)+sah"]));
    let summary = document["summary"].as_array().unwrap();
    assert_eq!(summary.len(), 2);
    for (line, spec) in summary.iter().zip(["kd+sah", "kd(prune=none)+sah"]) {
        assert_eq!((line["spec"].as_str(), line["base"].as_str()), (Some(spec), Some("kd+rdh")));
        for ratio in ["steps_ratio", "tests_ratio", "time_ratio", "build_ratio", "bytes_ratio"] {
            assert!(line[ratio].as_f64().unwrap() > 0.0, "{ratio}");
        }
        assert_eq!(line["time_ratio_ci95"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn counts_are_the_same_on_any_number_of_threads() {
    let counts = |threads| {
        let rows = json(&small(&["tetra5", "--mode", "path", "--json", "--threads", threads]))["rows"].take();
        let names = ["class", "spec", "hits", "t_sum", "steps_per_ray", "tests_per_ray", "bytes"];
        let row = |r: &Value| names.map(|name| r[name].clone());
        rows.as_array().unwrap().iter().map(row).collect::<Vec<_>>()
    };
    assert_eq!(counts("1"), counts("3"));
}

#[test]
fn the_table_names_what_was_compared() {
    let ran = rdh(&small(&["sombrero1"])).succeeded();
    for word in ["sombrero1:", "kd+sah", "kd+rdh(paper)", "kd+rdh", "steps", "95 % interval", "32 x 32", "seed 1"] {
        assert!(ran.stdout.contains(word), "no '{word}' in:\n{}", ran.stdout);
    }
    // Bars are for terminals.
    assert_eq!(ran.stderr, "");
}

#[test]
fn one_view_and_several_modes() {
    let all = json(&small(&["tetra5", "--json", "--spec", "kd+sah"]));
    let view = all["rows"][0]["view"].as_str().unwrap();
    let name = format!("tetra5:{view}");
    let args = ["compare", &name, "--json", "--spec", "kd+sah", "--mode", "casting,ao", "--size", "16x16"];
    let rows = json(&args)["rows"].take();
    let classes: Vec<_> = rows.as_array().unwrap().iter().map(|r| r["class"].as_str().unwrap()).collect();
    assert_eq!(classes, ["primary", "primary", "ao"]);
}

#[test]
fn training_rays_come_from_where_they_are_said_to() {
    let run = |scene: &'static str, source: &'static str| {
        let args = [scene, "--spec", "kd+sah,kd+rdh", "--rrs", source, "--json"];
        let document = json(&small(&args));
        let row = document["rows"][1].clone();
        (row["train_view"].as_str().map(str::to_owned), row["rrs_secs"].as_f64(), row["protocol"].clone())
    };
    assert_eq!(run("flat:room", "view:window").0.as_deref(), Some("window"));
    assert_eq!(run("flat:room", "all").0.as_deref(), Some("all"));
    let (view, secs, protocol) = run("flat:room", "frame:1/16");
    assert!(view.as_deref() == Some("room") && secs > Some(0.0) && protocol == "paper");
    let (view, secs, _) = run("flat:walk@60", "previous:4");
    assert_eq!((view.as_deref(), secs), (Some("walk@56"), Some(0.0)));
}

#[test]
fn sources_that_give_no_rays_are_refused() {
    rdh(&small(&["flat", "--rrs", "everything"])).failed(2, &["everything", "frame:1/N"]);
    rdh(&small(&["flat", "--rrs", "none"])).failed(2, &["kd+rdh", "needs rays"]);
    rdh(&small(&["flat:walk@500"])).failed(2, &["walk@500", "frames 0 to"]);
}

#[test]
fn a_subset_is_summed_up_by_itself() {
    let specs = ["--spec", "kd+sah,kd(prune=none)+sah"];
    let args = [&["sombrero1", "tetra5", "--first", "--subset", "tetra5"][..], &specs].concat();
    let text = rdh(&small(&args)).succeeded().stdout;
    let (all, subset) = text.split_once("\ntetra5:\n").expect("the subset has a heading");
    // Pairs of the summary's line: a view of each scene; the subset's has one.
    let pairs = |part: &str| {
        let lines = part.lines().filter(|line| line.starts_with("kd(prune=none)+sah") && line.contains(" to "));
        lines.map(|line| line.split_whitespace().nth(2).unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!((pairs(all), pairs(subset)), (vec!["2".to_owned()], vec!["1".to_owned()]));
    rdh(&small(&["tetra5", "--subset", "sombrero1"])).failed(2, &["sombrero1", "none of the scenes"]);
    rdh(&small(&["tetra5", "--subset", "tetra5", "--json"])).failed(2, &["--subset", "--json"]);
}
