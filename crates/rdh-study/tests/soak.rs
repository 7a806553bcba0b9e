//! Rays from inside closed meshes: none escapes, and all structures agree; the long version is `cargo xtask soak`.

use rdh::simd::Level;
use rdh::{Mesh, Spec};
use rdh_study::identical::FAMILIES;
use rdh_study::soak::{Aim, Batches, Closed, Detail, Form, Plan, Tally, closed_meshes, large_mesh, soak, soak_batches};

fn plan(specs: &str, casts: u64, brute: bool) -> Plan {
    let mut specs = Spec::list(specs).expect(specs);
    // What it chooses is one of the others.
    specs.retain(|spec| *spec != Spec::AUTO);
    Plan { specs, casts, seed: 7, brute }
}

fn run(meshes: &[Closed], plan: &Plan) -> Tally {
    let share = plan.casts / meshes.len() as u64;
    let tallies = meshes.iter().enumerate().map(|(i, closed)| soak(closed, i, share, None, plan).expect("it builds"));
    tallies.fold(Tally::default(), Tally::plus)
}

#[test]
fn none_of_ten_million_rays_escapes() {
    let tally = run(&closed_meshes(Detail::Coarse), &plan(FAMILIES, 10_000_000, false));
    assert_eq!((tally.misses, tally.different, &tally.faults[..]), (0, 0, &[][..]));
    assert!(tally.casts >= 10_000_000, "{}", tally.casts);
    assert_eq!(tally.by_level.len(), Level::available().len());
    let cells = tally.by_structure.iter().flatten();
    assert!(cells.clone().count() > 100 && cells.clone().all(|[casts, ..]| *casts > 50_000), "{tally:?}");
}

#[test]
fn all_agree_with_brute_force() {
    let tally = run(&closed_meshes(Detail::Coarse), &plan(FAMILIES, 3_000_000, true));
    assert_eq!((tally.misses, tally.different, &tally.faults[..]), (0, 0, &[][..]));
    assert!(tally.rays > 50_000, "{}", tally.rays);
}

#[test]
fn batches_miss_nothing_that_single_rays_hit() {
    let meshes: Vec<Closed> = closed_meshes(Detail::Coarse).into_iter().chain([large_mesh()]).collect();
    let share = 200_000 / meshes.len() as u64;
    let all = meshes.iter().enumerate().map(|(i, closed)| soak_batches(closed, i, share, 7).expect("it builds"));
    let batches = all.fold(Batches::default(), Batches::plus);
    assert!(batches.is_clean(), "{batches:?}");
    assert!(batches.by_form.iter().all(|[casts, ..]| *casts >= 400_000), "{batches:?}");
}

#[test]
fn what_escapes_from_batches_is_counted() {
    let batches = soak_batches(&leaky(), 0, 300_000, 7).expect("it builds");
    let [tiles, ..] = batches.by_form;
    assert!(tiles[1] > 0 && tiles[2] == 0 && !batches.faults.is_empty(), "{batches:?}");
    assert!(batches.faults[0].contains("icosphere, ") && Form::ALL.len() == batches.by_form.len());
}

/// A sphere with one triangle missing.
fn leaky() -> Closed {
    let whole = closed_meshes(Detail::Coarse).swap_remove(0);
    let mesh = Mesh::new(whole.mesh.positions().to_vec(), whole.mesh.triangles()[1..].to_vec()).expect("a valid mesh");
    Closed { mesh, ..whole }
}

#[test]
fn what_escapes_is_counted_and_shown() {
    let tally = soak(&leaky(), 0, 1_200_000, None, &plan("kd+sah,bvh8+sah", 0, false)).expect("it builds");
    assert!(tally.misses > 50 && tally.different == 0 && !tally.is_clean(), "{tally:?}");
    assert!(tally.faults.len() > 5 && tally.faults[0].contains("icosphere, kd+sah, "), "{:?}", tally.faults.first());
    let anywhere = tally.by_structure[0][Aim::Anywhere as usize];
    assert!(anywhere[1] > 0 && anywhere[1] < anywhere[0] / 20, "{anywhere:?}");
}

#[test]
fn threads_change_nothing() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| soak(&leaky(), 3, 200_000, None, &plan("kd+sah,bvh8+rdh", 0, true)).expect("it builds"))
    };
    assert_eq!(with(1), with(3));
}
