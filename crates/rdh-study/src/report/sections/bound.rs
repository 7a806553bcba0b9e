//! What could any tree gain?

use maud::{Markup, html};

use super::super::effect::Effect;
use super::super::svg::Entry;
use super::super::table::{ratio, table};
use super::super::view::Study;
use super::super::words;
use super::common::forest_figure;
use super::curves::curve_plots;
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "bound",
    title: "The bound",
    question: "How much could any kd-tree gain, if it knew the rays and were built without greed?",
    write,
};

/// What is weighed by c_t and c_i, and what it is made of; the first is what trees are built for.
const QUANTITIES: [&str; 3] = ["cost", "steps", "tests"];

fn write(study: &Study<'_>) -> Option<Section> {
    let curves: Vec<&Curve> = study.records_of("bound").flat_map(|r| &r.curves).collect();
    if curves.is_empty() {
        return None;
    }
    let series = all_series(&curves);
    let caption = html! {
        "Expected cost of each tree on test rays, relative to its base; means over scenes with 95\u{a0}% intervals. The least in each group is the bound "
        "that was found."
    };
    let body = html! {
        p {
            "On a " em { "lattice" } " of few planes, in scenes of a few hundred triangles, the cheapest of all trees can be found; its base is the greedy tree "
            "by areas on the same lattice. In larger scenes a " em { "search" } " goes from tree to better tree, and its base is " code { "kd+sah" }
            ". A tree “by rays” learns from training rays; one “by oracle” learns from the very rays that it is tested on, which no sample can beat."
        }
        (forest_figure(&entries(&series), "cost, ratio to the base: left of 1 is better", &caption))
        (trees_table(&series))
        (curve_plots(study, &curves))
    };
    Some(Section { findings: groups(&series).into_iter().filter_map(|g| finding(&g, &series)).collect(), body })
}

/// One kind of tree, over all scenes.
#[derive(Debug)]
struct Series {
    group: String,
    tree: String,
    /// Of each of [`QUANTITIES`].
    effects: [Option<Effect>; 3],
}

/// Of each of [`QUANTITIES`]: scenes, and ratios in them.
type Ratios<'c> = [Vec<(&'c str, f64)>; 3];

/// Curves of single points, named `quantity: group, tree`.
fn all_series(curves: &[&Curve]) -> Vec<Series> {
    let mut named: Vec<(String, String, Ratios<'_>)> = Vec::new();
    for curve in curves {
        let [point] = curve.points[..] else { continue };
        let Some((quantity, name)) = curve.name.split_once(": ") else { continue };
        let Some(index) = QUANTITIES.iter().position(|q| *q == quantity) else { continue };
        let (group, tree) = parts(name, &curve.spec.to_string());
        let at = named.iter().position(|n| (&n.0, &n.1) == (&group, &tree)).unwrap_or_else(|| {
            named.push((group, tree, Default::default()));
            named.len() - 1
        });
        named[at].2[index].push((&curve.scene, point[1]));
    }
    let series = |(group, tree, ratios): (String, String, Ratios<'_>)| Series {
        group,
        tree,
        effects: ratios.map(Effect::of_ratios),
    };
    named.into_iter().map(series).collect()
}

/// The group with its price of leaves, and the tree with its heuristic where its name doesn't tell.
fn parts(name: &str, spec: &str) -> (String, String) {
    let (group, tree) = name.split_once(", ").unwrap_or(("", name));
    let leaves = if spec.contains("leaf=1") { "tests of single triangles" } else { "tests of eight triangles" };
    let heuristic = if spec.contains("rdh") { "rdh" } else { "sah" };
    let tree = if tree.starts_with("built") { format!("{tree}, {heuristic}") } else { tree.to_owned() };
    (words::capital(&format!("{group}, {leaves}")), tree)
}

fn groups(series: &[Series]) -> Vec<String> {
    let mut groups: Vec<String> = Vec::new();
    for s in series {
        if !groups.contains(&s.group) {
            groups.push(s.group.clone());
        }
    }
    groups
}

fn finding(group: &str, series: &[Series]) -> Option<Markup> {
    let cost = |s: &Series| s.effects[0];
    let inside: Vec<&Series> = series.iter().filter(|s| s.group == *group).collect();
    let best = inside.iter().filter(|s| cost(s).is_some()).min_by(|a, b| mean(a).total_cmp(&mean(b)))?;
    let built = inside.iter().find(|s| s.tree == "built, rdh").and_then(|s| cost(s));
    Some(html! {
        (group) ": the best tree found (“" (best.tree) "”) costs " (words::figures(&cost(best)?)) " of the base"
        @if let Some(built) = built { ", the one that " code { "rdh" } " builds " (words::figures(&built)) }
        "; " (words::count(cost(best)?.scenes, "scene"))
    })
}

fn mean(series: &Series) -> f64 {
    series.effects[0].map_or(f64::INFINITY, |e| e.mean)
}

fn entries(series: &[Series]) -> Vec<Entry> {
    let mut entries = Vec::new();
    for group in groups(series) {
        entries.push(Entry::Head(group.clone()));
        for s in series.iter().filter(|s| s.group == group) {
            entries.extend(s.effects[0].map(|effect| Entry::Mean { label: s.tree.clone(), series: 0, effect }));
        }
    }
    entries
}

fn trees_table(series: &[Series]) -> Markup {
    let mut rows = Vec::new();
    for group in groups(series) {
        rows.push(vec![html! { (group) }]);
        rows.extend(series.iter().filter(|s| s.group == group).map(row));
    }
    table("The bound, and what is on the way to it", &["tree", ">scenes", ">cost", ">steps", ">tests"], &rows)
}

fn row(series: &Series) -> Vec<Markup> {
    let scenes = series.effects[0].map_or(0, |e| e.scenes);
    let mut row = vec![html! { (series.tree) }, html! { (scenes) }];
    row.extend(series.effects.map(|e| e.map_or_else(|| html! { "–" }, |e| ratio(&e))));
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_taken_apart() {
        let expected = ("Lattice, tests of single triangles".to_owned(), "built, rdh".to_owned());
        assert_eq!(parts("lattice, built", "kd(leaf=1)+rdh"), expected);
        let expected = ("Search, tests of eight triangles".to_owned(), "searched by rays".to_owned());
        assert_eq!(parts("search, searched by rays", "kd+rdh"), expected);
    }
}
