//! Trees and answers are the same in every bit, however they are made; the long version is `cargo xtask deep identical`.

use rdh::Spec;
use rdh_scene::catalog;
use rdh_study::identical::{Comparison, FAMILIES, compare};

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
