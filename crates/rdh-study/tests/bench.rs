//! The race against a competitor that is right, wrong, slow or absent.

use std::path::{Path, PathBuf};

use rdh_scene::catalog;
use rdh_study::Target;
use rdh_study::bench::{
    BenchDocument, BenchEvent, BenchPlan, BenchRow, Column, Form, Log, Pace, Queries, Registration, Settings, bench,
};

/// The folder of the test's competitor.
fn programs() -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_rdh-engine-naive")).parent().unwrap().to_path_buf()
}

fn naive(name: &str, mode: &str) -> Registration {
    Registration::new(name, "rdh-engine-naive", &[mode])
}

fn plan(engines: Vec<Registration>) -> BenchPlan {
    BenchPlan {
        targets: vec![Target::all(catalog::find("tetra5", &[]).unwrap())],
        specs: vec!["bvh8+sah".parse().unwrap(), "kd+sah".parse().unwrap()],
        columns: vec![Column::Rows, Column::Bounce],
        engines,
        programs: Some(programs()),
        size: 24,
        slow_size: 8,
        rounds: 2,
        ..BenchPlan::default()
    }
}

fn race(plan: &BenchPlan) -> BenchDocument {
    bench(plan, &[], &mut |_| ()).unwrap()
}

fn rows<'d>(document: &'d BenchDocument, base: &str) -> Vec<&'d BenchRow> {
    document.rows.iter().filter(|row| row.base.as_deref() == Some(base)).collect()
}

#[test]
fn an_engine_with_right_answers_is_compared() {
    let document = race(&plan(vec![naive("good", "exact")]));
    assert!(document.failures.is_empty() && document.skipped.is_empty(), "{:?}", document.failures);
    assert_eq!(document.rows.len(), 2 * 5);
    for row in &document.rows {
        let first = document.rows.iter().find(|first| first.column == row.column).unwrap();
        assert_eq!((row.hits, row.t_sum, row.rays), (first.hits, first.t_sum, first.rays));
        assert!(row.agrees && row.hits > 0 && row.mrays_per_sec > 0.0 && row.mrays_per_sec <= row.mrays_per_sec_best);
    }
    let good = rows(&document, "good");
    assert_eq!((good[0].engine.as_str(), good[0].bytes, good[0].build_secs), ("good(exact)", 77, 5e-6));
    assert_eq!(good[0].version.as_deref(), Some("1.2.3"));
    // It always says that it takes a millisecond.
    assert!((good[0].mrays_per_sec - 0.576).abs() < 1e-9);
    let keys: Vec<_> = document.summary.iter().map(|s| (s.column, s.spec.as_str(), s.base.as_str(), s.n)).collect();
    let [rows, bounce] = [Column::Rows, Column::Bounce];
    let ours = ["bvh8+sah", "kd+sah", "batch(bvh8+sah)", "batch(kd+sah)"];
    let all = [rows, bounce].into_iter().flat_map(|column| ours.map(|spec| (column, spec, "good", 1)));
    assert_eq!(keys, all.collect::<Vec<_>>());
    let ours = document.rows.iter().find(|row| row.is_ours()).unwrap();
    let speedup = ours.mrays_per_sec / good[0].mrays_per_sec;
    assert!((document.summary[0].speedup / speedup - 1.0).abs() < 1e-12);
    assert_eq!((document.summary[0].worst_scene.as_str(), document.builds.len()), ("tetra5", 3));
}

#[test]
fn wrong_answers_are_shown_and_their_times_do_not_count() {
    let document = race(&plan(vec![naive("good", "exact"), naive("far", "far"), naive("blind", "blind")]));
    for row in rows(&document, "far") {
        assert!(!row.agrees && row.differ == row.hits && row.lost + row.extra == 0, "{row:?}");
    }
    for row in rows(&document, "blind") {
        assert!(!row.agrees && row.lost > 0 && row.hits == 0, "{row:?}");
    }
    assert_eq!(document.disagreements().count(), 4);
    assert!(document.summary.iter().all(|line| line.base == "good"));
}

#[test]
fn an_engine_that_is_absent_is_skipped_by_name_and_the_others_go_on() {
    let missing = Registration::new("missing", "rdh-engine-nowhere", &["a", "b"]);
    let document = race(&plan(vec![missing, naive("gone", "absent"), naive("good", "exact")]));
    let names: Vec<_> = document.skipped.iter().map(|s| s.engine.as_str()).collect();
    assert_eq!(names, ["missing", "gone"]);
    assert_eq!(document.skipped[1].reason, "its library is missing");
    assert!(document.failures.is_empty() && rows(&document, "good").len() == 2);
    let without = race(&BenchPlan { programs: None, ..plan(vec![naive("good", "exact")]) });
    assert_eq!((without.skipped.len(), without.rows.len(), without.failures.len()), (1, 8, 0));
}

#[test]
fn an_engine_that_breaks_is_a_failure_and_the_others_go_on() {
    let engines = ["sudden", "mad", "liar"].map(|mode| naive(mode, mode));
    let document = race(&plan([&engines[..], &[naive("good", "exact")]].concat()));
    let failed = |name: &str| document.failures.iter().filter(|f| f.engine.as_deref() == Some(name)).count();
    // One that talks nonsense has no columns; the others fail in both.
    assert_eq!(
        [failed("sudden(sudden)"), failed("mad(mad)"), failed("liar(liar)")],
        [2, 1, 2],
        "{:?}",
        document.failures
    );
    assert_eq!((rows(&document, "good").len(), rows(&document, "liar").len()), (2, 0));
}

#[test]
fn slow_engines_get_fewer_rays_and_are_compared_on_the_same() {
    let slow = Registration { pace: Pace::Slow, ..naive("slow", "exact") };
    let document = race(&plan(vec![slow]));
    assert!(document.rows.iter().filter(|row| row.is_ours()).all(|row| row.same_rays.is_empty()));
    let row = rows(&document, "slow")[0];
    assert_eq!((row.rays, row.same_rays.len()), (64, 4));
    let ours = document.rows.iter().find(|ours| ours.is_ours()).unwrap();
    assert_eq!((ours.rays, ours.engine.as_str()), (576, row.same_rays[0].spec.as_str()));
    let speedup = document.speedup(ours, "slow").unwrap();
    assert_eq!(speedup, row.same_rays[0].mrays_per_sec / row.mrays_per_sec);
}

#[test]
fn engines_take_part_in_what_they_can() {
    let closest = Registration { queries: Queries::Closest, ..naive("closest", "exact") };
    let packets = Registration { form: Form::Packets, ..naive("packets", "exact") };
    let small = Registration { most_triangles: 10, ..naive("small", "exact") };
    let columns = vec![Column::Tiles, Column::Shadow, Column::Bounce, Column::Ao];
    let document = race(&BenchPlan { columns, ..plan(vec![closest, packets, small]) });
    let of = |base| rows(&document, base).iter().map(|row| row.column).collect::<Vec<_>>();
    assert_eq!(of("closest"), [Column::Tiles, Column::Bounce]);
    assert_eq!(of("packets"), [Column::Tiles, Column::Shadow]);
    assert_eq!((of("small").len(), document.skipped[0].engine.as_str()), (0, "small"));
}

#[test]
fn engines_that_do_not_fit_into_memory_together_run_in_turn() {
    let packets = Registration { form: Form::Packets, ..naive("packets", "far") };
    let engines = vec![naive("one", "exact"), packets, naive("two", "exact"), naive("far", "far")];
    let plan = BenchPlan { memory_bytes: Some(1), tolerance: 1.0, columns: vec![Column::Rows], ..plan(engines) };
    let document = race(&plan);
    let order: Vec<_> = document.rows.iter().map(|row| row.engine.as_str()).collect();
    // The packets share a process with the last, yet stand where they were asked for.
    let ours = ["bvh8+sah", "kd+sah", "batch(bvh8+sah)", "batch(kd+sah)"];
    let others = ["one(exact)", "packets(far)", "two(exact)", "far(far)"];
    assert_eq!(order, [&ours[..], &others[..]].concat());
}

#[test]
fn specs_that_need_rays_are_trained_on_others() {
    let specs = vec!["kd+rdh".parse().unwrap(), "kd+sah".parse().unwrap()];
    let document = race(&BenchPlan { specs, ..plan(vec![naive("good", "exact")]) });
    let profiles: Vec<_> = document.summary.iter().map(|s| serde_json::to_value(s.profile).unwrap()).collect();
    assert_eq!(profiles, ["guided", "none"].repeat(4));
}

#[test]
fn an_interrupted_race_goes_on_and_gives_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("race.log");
    let plan = plan(vec![naive("good", "exact")]);
    let (mut log, known) = Log::open(&path, &Settings::of(&plan)).unwrap();
    let mut through = 0;
    let whole = bench(&plan, &known, &mut |event| {
        // As if it had been interrupted after the first column.
        if let BenchEvent::Done(record) = event {
            if through == 0 {
                log.append(record).unwrap();
            }
            through += 1;
        }
    })
    .unwrap();
    drop(log);
    let (_, known) = Log::open(&path, &Settings::of(&plan)).unwrap();
    let mut done = Vec::new();
    let rest = bench(&plan, &known, &mut |event| {
        if let BenchEvent::Done(record) = event {
            done.push(record.column);
        }
    })
    .unwrap();
    assert_eq!((known.len(), done), (1, vec![Column::Bounce]));
    let facts = |d: &BenchDocument| d.rows.iter().map(|r| (r.engine.clone(), r.column, r.hits)).collect::<Vec<_>>();
    assert_eq!(facts(&whole), facts(&rest));
    assert_eq!(whole.rows[0].mrays_per_sec, rest.rows[0].mrays_per_sec);
}

#[test]
fn failures_and_absent_engines_are_not_forgotten_when_a_race_goes_on() {
    let plan = plan(vec![naive("gone", "absent"), naive("liar", "liar"), naive("good", "exact")]);
    let mut records = Vec::new();
    let whole = bench(&plan, &[], &mut |event| {
        if let BenchEvent::Done(record) = event {
            records.push((*record).clone());
        }
    })
    .unwrap();
    assert_eq!((whole.failures.len(), whole.skipped.len()), (2, 1), "{:?}", whole.failures);
    for through in 0..=records.len() {
        let rest = bench(&plan, &records[..through], &mut |_| ()).unwrap();
        assert_eq!((&rest.failures, &rest.skipped), (&whole.failures, &whole.skipped), "after {through}");
    }
}

#[test]
fn leaky_twins_are_compared_with_their_original() {
    let spec = "bvh8+sah".parse().unwrap();
    let document = race(&BenchPlan { twin: Some(spec), ..plan(Vec::new()) });
    assert!(document.failures.is_empty() && document.disagreements().count() == 0, "{:?}", document.rows);
    for (name, _) in BenchPlan::TWINS.iter().filter(|_| document.skipped.is_empty()) {
        let twins = rows(&document, name);
        assert_eq!((twins.len(), twins[0].engine.clone()), (2, format!("{name}(bvh8+sah)")));
        let ours = document.rows.iter().find(|row| row.is_ours()).unwrap();
        assert!(twins[0].hits.abs_diff(ours.hits) <= 4 && document.speedup(ours, name).is_some());
    }
    let other = BenchPlan { twin: Some("kd+rdh".parse().unwrap()), ..plan(Vec::new()) };
    assert!(bench(&other, &[], &mut |_| ()).is_err());
}
