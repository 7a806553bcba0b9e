//! Trees and answers are the same in every bit, however they are made; the long version is `cargo xtask deep identical`.

use std::path::Path;

use rdh::{BuildOptions, Mesh, Query, Ray, RayClass, RaySample, Spec, Training};
use rdh_scene::catalog;
use rdh_study::identical::{Comparison, FAMILIES, compare, digest};

#[test]
fn trees_and_answers_are_the_same_however_they_are_made() {
    let specs = Spec::list(FAMILIES).expect("known specs");
    let wanted = Comparison { specs, threads: vec![1, 2, 7], size: 32, pairs: 3_000_000 };
    for name in ["balls3", "teapot12"] {
        let entry = catalog::find(name, &[]).expect(name);
        let compared = compare(&entry, &wanted).expect(name);
        assert_eq!(compared.faults, [""; 0], "{name}");
        assert!(compared.by_brute_force > 100 && compared.answers > 10_000, "{name}: {compared:?}");
    }
}

/// Hills of 40 × 40 squares, out of sums, products and quotients alone, which every platform rounds alike.
fn hills() -> Mesh {
    const N: u32 = 40;
    let height = |i: u32, j: u32| ((i * 37 + j * 91) % 17) as f32 * 0.02 + ((i / 8 + j / 12) % 5) as f32 * 0.1;
    let row = |j: u32| (0..=N).map(move |i| [i as f32 / N as f32, j as f32 / N as f32, height(i, j)]);
    let at = |i: u32, j: u32| j * (N + 1) + i;
    let square =
        |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let triangles = (0..N).flat_map(|j| (0..N).flat_map(move |i| square(i, j))).collect();
    Mesh::new((0..=N).flat_map(row).collect(), triangles).expect("a valid mesh")
}

/// Slanted rays over the hills, a third of them for any hit.
fn slanted() -> Training {
    let sample = |i: usize| {
        let at = |k: usize| ((i * k) % 1009) as f32 / 1009.0;
        let ray = Ray::new([at(7), at(13), 1.5], [at(29) - 0.5, at(31) - 0.5, -0.3]);
        let query = if i.is_multiple_of(3) { Query::Occluded } else { Query::Closest };
        RaySample::new(ray, None, query, RayClass::Other)
    };
    Training::from_samples((0..1000).map(sample).collect())
}

/// The same on every platform: where one differs, it says which.
#[test]
fn structures_have_the_digests_that_are_written_down() {
    let (mesh, training) = (hills(), slanted());
    let line = |spec: Spec| {
        let options = BuildOptions { threads: Some(2), ..BuildOptions::default() };
        format!("{} {spec}\n", digest(&rdh::build(&mesh, &spec, &training, &options).expect("it builds")))
    };
    let mut specs = Spec::list(FAMILIES).expect("known specs");
    // What it chooses is one of the others.
    specs.retain(|spec| *spec != Spec::AUTO);
    let found: String = specs.into_iter().map(line).collect();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sha256.txt");
    if std::env::var_os("RDH_GOLDEN").is_some_and(|how| how == "write") {
        std::fs::write(&golden, &found).expect("a file that can be written");
    }
    let known = std::fs::read_to_string(&golden).expect("tests/golden/sha256.txt");
    let differ: Vec<_> = found.lines().filter(|line| !known.lines().any(|known| known == *line)).collect();
    assert!(differ.is_empty() && found.lines().count() == known.lines().count(), "other digests:\n{differ:#?}");
}
