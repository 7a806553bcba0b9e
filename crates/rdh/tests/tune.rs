//! Choosing: repeatable, sure of what it says, and never lost in what a profile may hold.

mod common;

use common::meshes::{self, Random};
use rdh::tune::{Confirmed, Evidence, Measure, Outcome, confirm};
use rdh::{
    BuildOptions, Error, HeldOut, Mesh, Profile, Query, Ray, RayClass, RaySample, Spec, Training, TuneOptions, Tuned,
    build, naive, tune,
};

const FEW: &str = "bvh8+sah,kd+sah,bvh8+rdh,kd+rdh";

/// A fine sphere behind a wall that hides it from the eye at [`EYE`].
fn hidden() -> Mesh {
    let sphere = meshes::icosphere(4);
    let (mut positions, mut triangles) = (sphere.positions().to_vec(), sphere.triangles().to_vec());
    let first = positions.len() as u32;
    let n = 24;
    for i in 0..(n + 1) * (n + 1) {
        let at = |k: u32| (k as f32 / n as f32 - 0.5) * 8.0;
        positions.push([at(i % (n + 1)), -1.5, at(i / (n + 1))]);
    }
    for i in (0..n * n).map(|i| first + i / n * (n + 1) + i % n) {
        triangles.extend([[i, i + 1, i + n + 2], [i, i + n + 2, i + n + 1]]);
    }
    Mesh::new(positions, triangles).unwrap()
}

const EYE: [f32; 3] = [0.0, -6.0, 0.0];

/// Rays from an eye at the mesh's box, with their hits; half of them ask only whether anything is hit.
fn seen_from(mesh: &Mesh, eye: [f32; 3], count: usize, seed: u64) -> Profile {
    let accel = build(mesh, &"bvh8+sah".parse().unwrap(), &Training::none(), &BuildOptions::default()).unwrap();
    let (mut random, bounds) = (Random::new(seed), mesh.bounds());
    let mut sample = |i: usize| {
        let target = [0, 1, 2].map(|a| random.between(bounds.min[a], bounds.max[a]));
        let ray = Ray::new(eye, [0, 1, 2].map(|a| target[a] - eye[a]));
        let (query, class) = [(Query::Closest, RayClass::Primary), (Query::Occluded, RayClass::Shadow)][i % 2];
        RaySample::new(ray, accel.closest(&ray), query, class)
    };
    Profile::from_samples((0..count).map(&mut sample).collect(), seed)
}

fn specs(text: &str) -> Vec<Spec> {
    Spec::list(text).unwrap()
}

fn by_counts(mesh: &Mesh, candidates: &str, profile: Profile) -> Tuned {
    let (training, held_out, _) = profile.split(1);
    tune(mesh, &specs(candidates), &training, &held_out, &TuneOptions::default(), None).unwrap()
}

/// The tree answers as brute force does.
fn agrees_with_brute_force(tuned: &Tuned, mesh: &Mesh) {
    for ray in common::rays::mixed(mesh, 200, 5) {
        assert_eq!(tuned.accel.closest(&ray), naive::closest(mesh, &ray), "{ray:?}");
    }
}

#[test]
fn where_rays_are_stopped_a_structure_for_them_wins_and_the_third_set_agrees() {
    let mesh = hidden();
    let (training, held_out, unseen) = seen_from(&mesh, EYE, 8000, 3).split(1);
    // So far apart that there is no doubt.
    let candidates = specs("kd+sah,bvh8+rdh");
    let tuned = tune(&mesh, &candidates, &training, &held_out, &TuneOptions::default(), None).unwrap();
    let evidence = &tuned.evidence;
    assert_eq!((evidence.outcome, evidence.measure), (Outcome::Rays, Measure::Counts), "{evidence:#?}");
    let taken = evidence.taken().unwrap();
    let comparison = taken.comparison.as_ref().unwrap();
    assert!(comparison.interval.unwrap()[1] < 1.0 && comparison.p_faster < evidence.risk, "{comparison:?}");
    assert!(evidence.spec.needs_rays() && !evidence.base.needs_rays());
    assert_eq!(evidence.spec, tuned.accel.stats().spec);
    assert!(evidence.reason.starts_with(&evidence.spec.to_string()), "{}", evidence.reason);
    let saved = rdh::Accel::from_bytes(&tuned.accel.to_bytes().unwrap()).unwrap();
    let kept: Evidence = serde_json::from_value(saved.provenance().evidence.clone().unwrap()).unwrap();
    assert_eq!(kept, *evidence);
    assert!(taken.gap.is_some_and(|gap| (0.9..1.2).contains(&gap)), "{:?}", taken.gap);
    let confirmed = confirm(&tuned, &unseen, &TuneOptions::default(), None).unwrap().unwrap();
    assert!(confirmed.counts.ratio < 1.0 && !confirmed.is_slower(0.05) && confirmed.time.is_none());
    agrees_with_brute_force(&tuned, &mesh);
}

#[test]
fn the_cheapest_by_areas_is_kept_where_no_rays_help() {
    // A tree that is built with rays of no weight is the one without, byte for byte: its ratio is 1, and 1 is not below 1.
    let tuned = by_counts(&hidden(), "kd+sah,kd+rdh(paper,weight=0)", seen_from(&hidden(), EYE, 4000, 3));
    let evidence = &tuned.evidence;
    assert_eq!((evidence.outcome, evidence.spec.to_string().as_str()), (Outcome::Areas, "kd+sah"));
    let comparison = evidence.trials[1].comparison.as_ref().unwrap();
    assert_eq!((comparison.ratio, comparison.p_faster), (1.0, 1.0));
    assert!(tuned.sah.is_none() && evidence.reason.starts_with("kd+sah is kept"), "{}", evidence.reason);
}

#[test]
fn by_counts_all_is_repeatable_on_any_number_of_threads() {
    let mesh = hidden();
    let on = |threads: usize| {
        let pool = rayon_pool(threads);
        pool.install(|| by_counts(&mesh, FEW, seen_from(&mesh, EYE, 3000, 3)))
    };
    let (one, many) = (on(1), on(3));
    assert_eq!(one.evidence, many.evidence);
    assert_eq!(one.accel.fingerprint(), many.accel.fingerprint());
    survives_json(&one.evidence);
}

/// The evidence is the same after it was text.
fn survives_json(evidence: &Evidence) {
    let text = serde_json::to_string(evidence).unwrap();
    assert_eq!(serde_json::from_str::<Evidence>(&text).unwrap(), *evidence);
}

fn rayon_pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[test]
fn whatever_a_profile_holds_there_is_a_tree_that_answers_rightly() {
    let mesh = hidden();
    let ray = Ray::new(EYE, [0.0, 1.0, 0.0]);
    let sample = |ray: Ray| RaySample::new(ray, None, Query::Closest, RayClass::Other);
    let nan = Ray::new([f32::NAN; 3], [f32::NAN; 3]);
    let outside = |i: usize| Ray::new([1e6 + i as f32, 1e6, 1e6], [1.0, 0.1, i as f32 * 1e-3]);
    let far_too_long = |i: usize| Ray::new([i as f32 * 1e-3, -6.0, 0.0], [f32::MIN_POSITIVE, 1e-38, 1e-38]);
    let mut mixed = seen_from(&mesh, EYE, 2000, 1).samples().to_vec();
    mixed.iter_mut().enumerate().for_each(|(i, s)| {
        (s.class, s.query) = (RayClass::ALL[i % 8], Query::ALL[i % 3]);
        s.weight = match i {
            i if i % 997 == 0 => u32::MAX,
            i if i % 7 == 0 => 0,
            i => 1 + i as u32 % 5,
        };
    });
    let profiles: Vec<(&str, Vec<RaySample>, Option<Outcome>)> = vec![
        ("empty", vec![], Some(Outcome::TooFewRays)),
        ("one ray", vec![sample(ray)], Some(Outcome::TooFewRays)),
        ("all NaN", vec![sample(nan); 5000], Some(Outcome::TooFewRays)),
        ("no direction", vec![sample(Ray::new(EYE, [0.0; 3])); 5000], Some(Outcome::TooFewRays)),
        ("of no length", (0..5000).map(|i| sample(ray.within(i as f32, i as f32))).collect(), None),
        ("all equal", vec![sample(ray); 5000], Some(Outcome::TooFewRays)),
        ("outside", (0..5000).map(|i| sample(outside(i))).collect(), None),
        ("slow", (0..5000).map(|i| sample(far_too_long(i))).collect(), None),
        ("another view", seen_from(&mesh, [3.0, 6.0, 1.0], 3000, 1).samples().to_vec(), None),
        ("mixed", mixed, None),
    ];
    for (name, samples, expected) in profiles {
        let (training, held_out) = (Training::from_samples(samples.clone()), HeldOut::from_samples(samples.clone()));
        let tuned = tune(&mesh, &specs(FEW), &training, &held_out, &TuneOptions::default(), None).unwrap();
        let evidence = &tuned.evidence;
        assert!(expected.is_none_or(|outcome| evidence.outcome == outcome), "{name}: {evidence:#?}");
        assert!(evidence.outcome != Outcome::TooFewRays || evidence.reason.contains("too few"), "{name}");
        survives_json(evidence);
        agrees_with_brute_force(&tuned, &mesh);
        let chosen = build(&mesh, &Spec::AUTO, &training, &BuildOptions::default());
        match samples.is_empty() {
            true => assert_eq!(chosen.unwrap_err(), Error::NoRays { spec: "auto".to_owned() }),
            false => assert_ne!(chosen.unwrap().stats().spec, Spec::AUTO, "{name}"),
        }
    }
}

#[test]
fn nasty_meshes_are_no_obstacle() {
    for (name, mesh) in meshes::nasty() {
        let sample = |ray| RaySample::new(ray, naive::closest(&mesh, &ray), Query::Closest, RayClass::Other);
        let samples: Vec<_> = common::rays::mixed(&mesh, 1600, 7).into_iter().map(sample).collect();
        let tuned = by_counts(&mesh, "bvh8+sah,bvh8+rdh,kd+rdh", Profile::from_samples(samples, 1));
        assert_eq!(tuned.accel.check(&mesh), [], "{name}");
        agrees_with_brute_force(&tuned, &mesh);
    }
}

#[test]
fn auto_is_the_choice_of_two_thirds_by_the_other_third() {
    let mesh = hidden();
    let (training, ..) = seen_from(&mesh, EYE, 4000, 3).split(1);
    let built = build(&mesh, &Spec::AUTO, &training, &BuildOptions::default()).unwrap();
    let tuned = tune::auto(&mesh, &training, &BuildOptions::default()).unwrap();
    assert_eq!(built.fingerprint(), tuned.accel.fingerprint());
    let rays = tuned.evidence.rays;
    assert_eq!(rays.training + rays.held_out, training.len());
    assert!((0.28..0.39).contains(&(rays.held_out as f64 / training.len() as f64)), "{rays:?}");
    assert_eq!(tuned.evidence.trials.len(), Spec::candidates().len());
    assert!(built.stats().trained_on == rays.training || !built.stats().spec.needs_rays());
}

#[test]
fn what_one_candidate_may_not_need_the_others_may() {
    let mesh = hidden();
    let profile = seen_from(&mesh, EYE, 4000, 3);
    let all = by_counts(&mesh, "bvh8+sah,bvh2+sah,bvh8+rdh", profile.clone()).evidence;
    let bytes: Vec<usize> = all.trials.iter().map(|t| t.bytes.unwrap()).collect();
    let (least, most) = (*bytes.iter().min().unwrap(), *bytes.iter().max().unwrap());
    assert!(least < most);
    let options = |max_bytes| TuneOptions {
        build: BuildOptions { max_bytes: Some(max_bytes), ..BuildOptions::default() },
        ..TuneOptions::default()
    };
    let (training, held_out, _) = profile.split(1);
    let tuned =
        tune(&mesh, &specs("bvh8+sah,bvh2+sah,bvh8+rdh"), &training, &held_out, &options(most - 1), None).unwrap();
    let errors = tuned.evidence.trials.iter().zip(&bytes).map(|(t, &b)| (t.error.is_some(), b == most));
    assert!(errors.clone().all(|(failed, too_large)| failed == too_large), "{:?}", tuned.evidence.trials);
    assert!(tuned.evidence.trials.iter().flat_map(|t| &t.error).all(|e| e.contains("bytes")));
    let none = tune(&mesh, &specs(FEW), &training, &held_out, &options(100), None).unwrap_err().to_string();
    assert!(none.contains("no structure by areas") && none.contains("100 bytes"), "{none}");
}

#[test]
fn a_build_that_takes_too_long_is_out_and_who_cancels_gets_nothing() {
    use std::sync::atomic::{AtomicU64, Ordering};
    let mesh = hidden();
    let (training, held_out, _) = seen_from(&mesh, EYE, 4000, 3).split(1);
    let ticks = AtomicU64::new(0);
    let clock = || ticks.fetch_add(1_000_000_000, Ordering::Relaxed);
    let slow = TuneOptions { max_build_secs: Some(0.5), ..TuneOptions::default() };
    let error = tune(&mesh, &specs(FEW), &training, &held_out, &slow, Some(&clock)).unwrap_err().to_string();
    assert!(error.contains("'bvh8+sah' takes more than 0.5 s"), "{error}");
    let cancel = || true;
    let build = BuildOptions { cancel: Some(&cancel), ..BuildOptions::default() };
    let cancelled =
        tune(&mesh, &specs(FEW), &training, &held_out, &TuneOptions { build, ..TuneOptions::default() }, None);
    assert_eq!(cancelled.unwrap_err(), Error::Cancelled);
}

#[test]
fn with_a_clock_time_decides_and_pays_for_the_build() {
    let mesh = hidden();
    let (training, held_out, unseen) = seen_from(&mesh, EYE, 8000, 3).split(1);
    let start = std::time::Instant::now();
    let clock = || start.elapsed().as_nanos() as u64;
    let tuned = tune(&mesh, &Spec::candidates(), &training, &held_out, &TuneOptions::default(), Some(&clock)).unwrap();
    let evidence = &tuned.evidence;
    assert_eq!(evidence.measure, Measure::Time);
    assert!(evidence.trials.iter().all(|t| t.build_secs.is_some_and(|s| s > 0.0) && !t.rungs.is_empty()));
    let timed = evidence.trials.iter().filter(|t| t.nanos_per_ray(Measure::Time).is_some()).count();
    assert_eq!(timed, 6, "{:#?}", evidence.trials);
    // Two of each kind are timed twice again, longer.
    assert_eq!(evidence.trials.iter().filter(|t| t.rungs.len() == 4 && t.rungs[3].kept).count(), 4);
    if evidence.outcome == Outcome::Rays {
        let confirmed: Confirmed = confirm(&tuned, &unseen, &TuneOptions::default(), Some(&clock)).unwrap().unwrap();
        assert!(confirmed.time.is_some());
        assert!(evidence.taken().unwrap().break_even_rays.is_some_and(|rays| rays >= 0.0));
    }
    agrees_with_brute_force(&tuned, &mesh);
}

#[test]
fn classes_count_as_much_as_is_asked_for() {
    let mesh = hidden();
    let (training, held_out, _) = seen_from(&mesh, EYE, 6000, 3).split(1);
    let weighed = |shadow: f64| {
        let mut options = TuneOptions::default();
        options.class_weights[RayClass::Shadow as usize] = shadow;
        tune(&mesh, &specs(FEW), &training, &held_out, &options, None).unwrap().evidence
    };
    let alone = weighed(0.0);
    let classes = |evidence: &Evidence| {
        let comparison = evidence.trials.iter().find_map(|t| t.comparison.clone()).unwrap();
        comparison.classes.iter().map(|c| c.class).collect::<Vec<_>>()
    };
    assert_eq!(classes(&alone), [RayClass::Primary]);
    assert_eq!(classes(&weighed(1.0)), [RayClass::Primary, RayClass::Shadow]);
    // A class that counts for nearly all pulls the cost of all rays to its own.
    let cost = |evidence: &Evidence| evidence.trials[0].nanos_per_ray(Measure::Counts).unwrap();
    let (none, some, all) = (cost(&alone), cost(&weighed(1.0)), cost(&weighed(1e6)));
    assert!((none < some) == (some < all) && none != all, "{none} {some} {all}");
}

#[test]
fn what_makes_no_sense_is_refused_and_says_why() {
    let mesh = hidden();
    let (training, held_out, _) = seen_from(&mesh, EYE, 2000, 3).split(1);
    let refused = |candidates: &str, options: TuneOptions<'_>, word: &str| {
        let error = tune(&mesh, &specs(candidates), &training, &held_out, &options, None).unwrap_err();
        assert!(matches!(&error, Error::Tuning { reason } if reason.contains(word)), "{error}");
    };
    let fine = TuneOptions::default();
    refused("kd+rdh,bvh8+rdh", fine, "needs no rays");
    refused("kd+sah,auto", fine, "'auto'");
    refused("kd+sah,kd+rdh,kd", fine, "twice");
    refused("kd+sah", TuneOptions { class_weights: [0.0; 8], ..fine }, "all class weights");
    refused("kd+sah", TuneOptions { class_weights: [f64::NAN; 8], ..fine }, "primary=NaN");
    refused("kd+sah", TuneOptions { risk: 0.0, ..fine }, "risk");
    refused("kd+sah", TuneOptions { margin: -1.0, ..fine }, "margin");
    refused("kd+sah", TuneOptions { rounds: 0, ..fine }, "rounds");
    refused("kd+sah", TuneOptions { max_build_secs: Some(1.0), ..fine }, "clock");
    let empty = tune(&mesh, &[], &training, &held_out, &fine, None).unwrap_err().to_string();
    assert!(empty.contains("needs no rays"), "{empty}");
}
