//! Whole runs: rows, documents, failures.

mod common;

use common::{boxes, entry, loader, plan, room};
use rdh::{RayClass, Spec};
use rdh_study::{Document, Event, Mode, Plan, Protocol, Row, Target, Verdict, run_loading, summarise};
use serde_json::Value;

fn run(plan: &Plan, scenes: &[rdh_scene::Scene]) -> Document {
    run_loading(plan, &loader(scenes.to_vec()), &mut |_| {}).unwrap()
}

/// A row without what a clock says.
fn timeless(row: &Row) -> Row {
    let row = row.clone();
    Row { nanos_per_ray: 0.0, round_nanos_per_ray: Vec::new(), build_secs: 0.0, rrs_secs: 0.0, ..row }
}

#[test]
fn a_run_has_a_row_for_each_view_mode_class_and_spec() {
    let scenes = [room(None), boxes(2)];
    let plan = Plan { modes: vec![Mode::Primary, Mode::Ao], ..plan(&scenes) };
    let mut told = Vec::new();
    let document = run_loading(&plan, &loader(scenes.to_vec()), &mut |event| {
        if let Event::Row(row) = event {
            told.push((*row).clone());
        }
    })
    .unwrap();
    // 2 scenes × 2 views × (1 + 2 classes) × 3 specs.
    assert_eq!(document.rows.len(), 2 * 2 * 3 * 3);
    assert_eq!(document.rows, told);
    assert_eq!((document.verdict(), document.failures.len()), (Verdict::Fine, 0));
    for row in &document.rows {
        let same = |other: &&Row| {
            (&other.scene, &other.view, other.mode, other.class) == (&row.scene, &row.view, row.mode, row.class)
        };
        let mine: Vec<&Row> = document.rows.iter().filter(same).collect();
        assert_eq!(mine.len(), 3);
        assert!(mine.iter().all(|o| o.hits == row.hits && o.t_sum == row.t_sum && o.rays == row.rays));
        assert_eq!(row.trained_on, if row.spec.needs_rays() { 500 } else { 0 });
        assert_eq!(row.train_view.is_some(), row.spec.needs_rays());
        assert!(row.steps_per_ray >= 1.0 && row.nanos_per_ray > 0.0 && row.build_secs > 0.0 && row.bytes > 0);
        assert_eq!((row.round_nanos_per_ray.len(), row.rrs_secs > 0.0), (2, row.spec.needs_rays()));
    }
    // primary; ao's primary, ao, and all; times two specs beside the base.
    let summary: Vec<_> = document.summary.iter().map(|s| (s.mode, s.class, s.n)).collect();
    let expected = [
        (Mode::Primary, Some(RayClass::Primary)),
        (Mode::Ao, Some(RayClass::Primary)),
        (Mode::Ao, Some(RayClass::Ao)),
        (Mode::Ao, None),
    ];
    assert_eq!(summary, expected.iter().flat_map(|&(m, c)| [(m, c, 4); 2]).collect::<Vec<_>>());
}

#[test]
fn rows_are_the_same_on_any_number_of_threads() {
    let scenes = [boxes(3)];
    let on = |threads| {
        let targets = vec![Target::view(entry(&scenes[0]), "inside")];
        let plan = Plan { threads: Some(threads), modes: Mode::ALL.to_vec(), targets, ..plan(&scenes) };
        run(&plan, &scenes).rows.iter().map(timeless).collect::<Vec<_>>()
    };
    let one = on(1);
    assert!(one.len() == 3 * (1 + 3 + 3 + 2 + 1), "{}", one.len());
    assert_eq!(one, on(3));
}

#[test]
fn another_seed_gives_other_rays() {
    let scenes = [boxes(2)];
    let t_sum = |seed| run(&Plan { seed, ..plan(&scenes) }, &scenes).rows[0].t_sum;
    assert_eq!(t_sum(1), t_sum(1));
    assert_ne!(t_sum(1), t_sum(2));
}

#[test]
fn a_scene_that_fails_does_not_stop_the_others() {
    let scenes = [room(None)];
    let mut missing = entry(&scenes[0]);
    missing.id = "missing".into();
    let mut plan = plan(&scenes);
    plan.targets.insert(0, Target::all(missing));
    plan.targets.push(Target::view(entry(&scenes[0]), "cellar"));
    let document = run(&plan, &scenes);
    assert_eq!(document.rows.len(), 2 * 3);
    assert_eq!(document.verdict(), Verdict::Failed);
    let reasons: Vec<_> = document.failures.iter().map(|f| (f.scene.as_str(), f.reason.as_str())).collect();
    assert_eq!(reasons, [("missing", "no such scene"), ("room", "unknown view 'cellar'; known: inside, up")]);
}

#[test]
fn plans_that_ask_for_nothing_are_refused() {
    let scenes = [room(None)];
    let good = plan(&scenes);
    assert!(good.check().is_ok());
    let bad = [
        (Plan { targets: Vec::new(), ..good.clone() }, "no scenes"),
        (Plan { specs: Vec::new(), ..good.clone() }, "no specs"),
        (Plan { modes: Vec::new(), ..good.clone() }, "no modes"),
        (Plan { size: [0, 5], ..good.clone() }, "no pixels"),
        (Plan { size: [usize::MAX, 5], ..good.clone() }, "at most"),
        (Plan { rounds: 0, ..good.clone() }, "no rounds"),
        (Plan { training: 0, ..good.clone() }, "no training rays"),
        (Plan { specs: vec![Spec::default(); 2], ..good.clone() }, "twice"),
        (Plan { modes: vec![Mode::Ao; 2], ..good.clone() }, "twice"),
    ];
    for (plan, why) in bad {
        let error = plan.check().unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
    // Without rays to learn from, SAH alone is fine.
    assert!(Plan { training: 0, specs: vec![Spec::default()], ..good }.check().is_ok());
}

#[test]
fn specs_that_all_need_rays_get_them_through_a_tree_that_counts_nowhere() {
    let scenes = [boxes(2)];
    let plan = Plan { specs: Spec::list("kd+rdh,kd+rdh(paper)").unwrap(), ..plan(&scenes) };
    let document = run(&plan, &scenes);
    assert_eq!(document.rows.len(), 2 * 2);
    assert!(document.rows.iter().all(|r| r.spec.needs_rays() && r.trained_on == 500));
}

#[test]
fn the_same_protocol_trains_on_all_test_rays() {
    let scenes = [boxes(2)];
    let plan = Plan { protocol: Protocol::Same, ..plan(&scenes) };
    for row in run(&plan, &scenes).rows.iter().filter(|r| r.spec.needs_rays()) {
        assert_eq!((row.trained_on as u64, row.protocol), (row.rays, Protocol::Same));
    }
}

#[test]
fn the_document_speaks_the_contract() {
    let scenes = [boxes(2)];
    let document = run(&Plan { modes: vec![Mode::Whitted], ..plan(&scenes) }, &scenes);
    let text = document.to_json().unwrap();
    assert!(Document::from_json(&text).unwrap() == document);
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["version"], 1);
    let row = [
        "scene",
        "view",
        "frame",
        "mode",
        "class",
        "spec",
        "triangles",
        "rays",
        "hits",
        "t_sum",
        "trained_on",
        "train_view",
        "train_frame",
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
    let summary = [
        "mode",
        "class",
        "spec",
        "base",
        "n",
        "steps_ratio",
        "tests_ratio",
        "time_ratio",
        "time_ratio_ci95",
        "build_ratio",
        "bytes_ratio",
        "slower_cases",
    ];
    for (name, fields) in [("rows", &row[..]), ("summary", &summary[..])] {
        for entry in json[name].as_array().unwrap() {
            for field in fields {
                assert!(entry.get(field).is_some(), "{name} lacks {field}");
            }
        }
    }
    let ours = json["rows"].as_array().unwrap().iter().find(|r| r["spec"] == "kd+rdh").unwrap();
    assert_eq!(
        (&ours["mode"], &ours["class"], &ours["train_view"]),
        (&"whitted".into(), &"primary".into(), &"inside".into())
    );
    assert!(json["rows"].as_array().unwrap().iter().any(|r| r["spec"] == "kd+sah" && r["train_view"].is_null()));
    let all = json["summary"].as_array().unwrap().iter().filter(|s| s["class"] == "all").count();
    assert_eq!(all, 2);
    assert_eq!(json["summary"][0]["time_ratio_ci95"].as_array().unwrap().len(), 2);
    assert!(json.get("failures").is_none() && json.get("mismatches").is_none());
}

#[test]
fn documents_that_are_not_ours_are_refused_with_a_reason() {
    let scenes = [room(None)];
    let text = run(&plan(&scenes), &scenes).to_json().unwrap();
    let cases = [
        (text.replace("\"version\":1", "\"version\":2"), "version 2"),
        (text.replace("\"class\":\"primary\"", "\"class\":\"gamma\""), "unknown class 'gamma'"),
        (text.replace("\"mode\":\"primary\"", "\"mode\":\"sonar\""), "unknown mode 'sonar'"),
        (text.replace("\"kd+sah\"", "\"oak+sah\""), "unknown name 'oak'"),
        (text.replace("\"hits\"", "\"hit\""), "missing field `hits`"),
        (text[..text.len() / 2].to_owned(), "EOF"),
    ];
    for (bad, why) in cases {
        let error = Document::from_json(&bad).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}

#[test]
fn a_summary_can_be_made_against_another_base() {
    let scenes = [boxes(2), room(None)];
    let document = run(&plan(&scenes), &scenes);
    let base: Spec = "kd+rdh(paper)".parse().unwrap();
    let other = summarise(&document.rows, &base);
    assert_eq!(other.iter().map(|s| s.spec.to_string()).collect::<Vec<_>>(), ["kd+sah", "kd+rdh"]);
    // The inverse of the first summary's row.
    let first = document.summary.iter().find(|s| s.spec == base).unwrap();
    assert!((other[0].steps_ratio * first.steps_ratio - 1.0).abs() < 1e-12);
    assert_eq!(summarise(&document.rows, &document.summary[0].base), document.summary);
}
