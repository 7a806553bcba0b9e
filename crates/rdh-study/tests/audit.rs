//! Choices keep their word on a few scenes; the long version is `cargo xtask deep audit`. And an audit finds what is wrong.

use rdh::Spec;
use rdh::tune::Outcome;
use rdh_scene::catalog;
use rdh_study::audit::{Audit, Finding, audit, each_risk};

fn findings(name: &str, wanted: &Audit) -> Vec<Finding> {
    let mut findings = Vec::new();
    audit(&catalog::find(name, &[]).expect(name), wanted, &mut |finding| findings.push(finding)).expect(name);
    findings
}

#[test]
fn choices_keep_their_word_whatever_the_rays_are() {
    let candidates = Spec::list("bvh8+sah,kd+sah,bvh8+rdh,kd+rdh").expect("known specs");
    let wanted = Audit { candidates, size: 64, ..Audit::default() };
    let all: Vec<Finding> = ["rooms", "tetra5"].iter().flat_map(|name| findings(name, &wanted)).collect();
    let risk = each_risk(&all, 0.05);
    let wrong: Vec<_> = all.iter().filter(|f| !f.violations(risk).is_empty()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    let ended = |wanted| all.iter().filter(|f| f.taken.is_some_and(|(_, outcome)| outcome == wanted)).count();
    assert!(ended(Outcome::Rays) > 5 && ended(Outcome::TooFewRays) >= 6, "{all:#?}");
    assert!(all.iter().any(|f| f.rays == "moved since" && f.warned.is_some()));
    // All in all the choices gain: not just no harm is done.
    let better = |f: &&Finding| f.hardest().is_some_and(|c| c.ratio < 0.95);
    assert!(all.iter().filter(better).count() > 5);
}

/// The bound is no formality: a structure that is taken for rays which it isn't good for is found out.
#[test]
fn a_choice_for_other_rays_is_found_slower_where_nobody_warns() {
    let candidates = Spec::list("sbvh8(high)+sah,sbvh8(high)+rdh").expect("known specs");
    let found = findings("flat", &Audit { candidates, size: 96, ..Audit::default() });
    let moved = found.into_iter().find(|f| f.rays == "moved since").expect("flat has several views");
    assert!(moved.violations(0.01).is_empty() && moved.warned.is_some_and(|drift| drift > 0.1), "{moved:#?}");
    let unwarned = Finding { warned: None, ..moved };
    assert!(unwarned.violations(0.01).iter().any(|v| v.contains("sbvh8(high)+sah")), "{unwarned:#?}");
    let broken = Finding { faults: vec!["can't be tuned".to_owned()], ..unwarned };
    assert!(broken.violations(1e-30).contains(&"can't be tuned".to_owned()));
}
