//! Ray counts of the procedural databases beside published ones.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::super::table::table;
use super::super::view::Study;
use super::super::words::{self, percent, signed};
use super::{Chapter, Section};
use crate::rows::Curve;
use crate::study::experiment::spd::PUBLISHED;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "spd",
    title: "Are these the scenes they claim to be?",
    question: "Havran published in 1999 how many rays of each sort the Standard Procedural Databases take. Do ours agree?",
    write,
};

/// Curves of one point: what was published, and ours.
fn write(study: &Study<'_>) -> Option<Section> {
    let curves = study.records_of("spd").flat_map(|r| &r.curves).filter(|c| c.points.len() == 1);
    let mut scenes: BTreeMap<&str, Vec<&Curve>> = BTreeMap::new();
    for curve in curves {
        scenes.entry(&curve.scene).or_default().push(curve);
    }
    let first = scenes.values().next()?;
    let mut heads = vec!["scene".to_owned()];
    for curve in first {
        heads.extend([format!(">{}", name(curve)), ">published".to_owned(), ">".to_owned()]);
    }
    heads.push("why ours differ".to_owned());
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let rows: Vec<Vec<Markup>> = scenes.iter().map(|(scene, curves)| row(scene, curves)).collect();
    let body = html! {
        (table("Rays an eye ray: ours, as published for 513 × 513 eye rays and depth 5, and the difference", &heads, &rows))
        p.note {
            "Ours are triangles with flat normals, a little smaller than the true spheres, cylinders and cones: silhouettes lose a little, and "
            "reflections between coarse spheres lose their way sooner, which shows most in the lattice. Gears, teapot and tetra are polygons in the "
            "original too. The film is smaller than the published one, so that counts are coarser."
        }
    };
    Some(Section { findings: finding(&scenes).into_iter().collect(), body })
}

/// The name without what all have in common.
fn name(curve: &Curve) -> &str {
    curve.name.split_once(',').map_or(curve.name.as_str(), |parts| parts.0)
}

fn finding(scenes: &BTreeMap<&str, Vec<&Curve>>) -> Option<Markup> {
    let off = |c: &&&Curve| (c.points[0][1] / c.points[0][0] - 1.0).abs();
    let all: Vec<&&Curve> = scenes.values().flatten().filter(|c| c.points[0][0] > 0.0).collect();
    let farthest = all.iter().max_by(|a, b| off(a).total_cmp(&off(b)))?;
    let near = all.iter().filter(|c| off(c) <= 0.05).count();
    Some(html! {
        (near) " of " (words::count(all.len(), "published count")) " are met to within " (percent(0.05)) "; the farthest off are the "
        (name(farthest)) " of " code { (farthest.scene) } ", by " (signed(farthest.points[0][1] / farthest.points[0][0]))
    })
}

fn row(scene: &str, curves: &[&Curve]) -> Vec<Markup> {
    let mut row = vec![html! { code { (scene) } }];
    for curve in curves {
        let [theirs, ours, _] = curve.points[0];
        let difference = if theirs > 0.0 { signed(ours / theirs) } else { String::new() };
        row.extend([html! { (format!("{ours:.3}")) }, html! { (format!("{theirs:.3}")) }, html! { (difference) }]);
    }
    let why = PUBLISHED.iter().find(|p| p.scene == scene).map_or("", |p| p.why);
    row.push(html! { (why) });
    row
}
