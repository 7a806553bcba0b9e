//! The experiments that look into trees, on a small scene.

mod common;

use common::{boxes, entry, loader, plan};
use rdh_study::Mode;
use rdh_study::study::{Job, Lab, Record, experiment};

/// Runs an experiment's job on a grid of `side`³ boxes in a room.
fn found(name: &str, mode: Mode, side: usize) -> Record {
    let scene = boxes(side);
    let (entry, plan) = (entry(&scene), plan(std::slice::from_ref(&scene)));
    let load = loader(vec![scene]);
    let lab = Lab::open(&entry, 0, &plan, &load, None).unwrap();
    let (experiment, scene, view) = (name.to_owned(), entry.id.clone(), "inside".to_owned());
    let mut found = Record::of(Job { experiment, scene, view, frame: 0, mode });
    experiment::find(name).expect(name).run(&lab, &mut found).unwrap();
    assert!(found.failures.is_empty() && found.mismatches.is_empty(), "{:?} {:?}", found.failures, found.mismatches);
    found
}

fn curve(found: &Record, name: &str, spec: &str) -> f64 {
    let curve = found.curves.iter().find(|c| c.name == name && c.spec.to_string() == spec);
    curve.unwrap_or_else(|| panic!("{name} of {spec}")).points[0][1]
}

#[test]
fn no_tree_is_cheaper_than_the_bound() {
    let found = found("bound", Mode::Primary, 2);
    for (leaf, built) in [("kd(leaf=1)", "kd(leaf=1)+rdh"), ("kd", "kd+rdh")] {
        let bound = curve(&found, "cost: lattice, optimal by oracle", built);
        for tree in ["optimal by rays", "greedy by rays", "greedy by oracle"] {
            assert!(curve(&found, &format!("cost: lattice, {tree}"), built) >= bound - 1e-9, "{leaf} {tree}");
        }
        assert!(curve(&found, "cost: lattice, optimal by areas", &format!("{leaf}+sah")) >= bound - 1e-9);
    }
}

#[test]
fn real_clipped_rays_predict_what_areas_do_not() {
    let found = found("assumptions", Mode::Primary, 3);
    let ratio = |guess: &str| curve(&found, &format!("cost predicted / measured, by {guess}, tree of sah"), "kd+sah");
    assert!((ratio("real clipped") - 1.0).abs() < 0.1, "{}", ratio("real clipped"));
    assert!((ratio("areas") / ratio("uniform whole") - 1.0).abs() < 0.15, "uniform lines are what areas have in mind");
    assert!(ratio("real whole") > 1.2, "whole rays go on behind what they hit");
    let settings: Vec<_> = found.rows.iter().filter_map(|r| r.setting.clone()).collect();
    assert_eq!(settings.len(), 8, "base and tree in each of four corners");
}

#[test]
fn idle_nodes_make_trees_smaller() {
    let found = found("termination", Mode::Primary, 9);
    let references = |spec: &str| {
        let row = found.rows.iter().find(|r| r.spec.to_string() == spec).expect(spec);
        (row.references, row.nodes)
    };
    let (all, some, few) = (references("kd+rdh"), references("kd(idle=0.0001)+rdh"), references("kd(idle=0.001)+rdh"));
    assert!(few.1 <= some.1 && some.1 <= all.1 && few.1 < all.1, "{all:?} {some:?} {few:?}");
    assert!(few.0 <= all.0);
    for setting in ["stop=paper", "idle: the learnt view's rays", "idle: another view's rays", "idle: uniform lines"] {
        assert!(found.rows.iter().any(|r| r.setting.as_deref() == Some(setting)), "{setting}");
    }
}

#[test]
fn every_source_of_rays_gives_a_tree_and_this_frames_are_paid_for() {
    let found = found("which-rays", Mode::Path, 3);
    let trained: Vec<_> = found.rows.iter().filter(|r| r.trained_on > 0).collect();
    let paid = |r: &&&rdh_study::Row| r.setting.as_deref().is_some_and(|s| s.starts_with("this frame"));
    assert!(trained.iter().filter(paid).all(|r| r.rrs_secs > 0.0) && trained.iter().any(|r| paid(&r)));
    let views: std::collections::BTreeSet<_> = trained.iter().filter_map(|r| r.train_view.clone()).collect();
    assert_eq!(views.into_iter().collect::<Vec<_>>(), ["all", "inside", "up"]);
    assert_eq!(found.curves.len(), 3);
    let is_right = |c: &&rdh_study::Curve| c.name.starts_with("rule");
    assert!(found.curves.iter().filter(is_right).flat_map(|c| &c.points).all(|p| p[1] == 0.0 || p[1] == 1.0));
}

#[test]
fn every_frame_is_paid_for_from_the_mesh_to_the_last_ray() {
    let scene = boxes(3);
    let (mut entry, plan) = (entry(&scene), plan(std::slice::from_ref(&scene)));
    entry.frames = 3;
    let load = loader(vec![scene]);
    let lab = Lab::open(&entry, 0, &plan, &load, None).unwrap();
    let (experiment, scene, view) = ("frames".to_owned(), entry.id.clone(), "inside".to_owned());
    let mut found = Record::of(Job { experiment, scene, view, frame: 0, mode: Mode::Primary });
    experiment::find("frames").expect("it is there").run(&lab, &mut found).unwrap();
    assert!(found.failures.is_empty() && found.mismatches.is_empty(), "{:?} {:?}", found.failures, found.mismatches);
    let frames: std::collections::BTreeSet<_> = found.rows.iter().filter_map(|r| r.x).map(|x| x as u32).collect();
    assert_eq!(frames.into_iter().collect::<Vec<_>>(), [1, 2]);
    let of = |spec: &'static str| found.rows.iter().filter(move |r| r.spec.to_string() == spec);
    // Two classes in two frames; all but the base stand in two settings.
    assert_eq!(of("kd(split=exact)+sah").count(), 4);
    for spec in ["bvh8(quick)+sah", "kd+sah", "bvh8(quick,lazy)+sah", "bvh8(lazy)+rdh", "kd(eye)+rdh", "auto"] {
        assert_eq!(of(spec).count(), 8, "{spec}");
        assert!(of(spec).all(|r| r.build_secs > 0.0 && r.nanos_per_ray > 0.0 && r.steps_per_ray > 0.0), "{spec}");
    }
    assert!(of("bvh8(lazy)+rdh").all(|r| r.rrs_secs > 0.0 && r.trained_on > 0));
    assert!(of("bvh8(quick,lazy)+sah").all(|r| r.rrs_secs == 0.0));
    assert!(of("kd(eye)+rdh").all(|r| r.rrs_secs == 0.0 && r.trained_on > 0));
    // Each candidate is tried once, in order.
    let chosen: Vec<String> = of("auto").step_by(4).filter_map(|r| Some(r.chosen?.to_string())).collect();
    assert_eq!(chosen, ["bvh8(quick,lazy)+sah", "bvh8(quick)+sah"]);
}
