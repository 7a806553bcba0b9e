//! What could any tree gain?

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::super::effect::Effect;
use super::super::pairs::Metric;
use super::super::svg::Entry;
use super::super::table::{Key, effects, ratio, table};
use super::super::view::Study;
use super::super::words;
use super::common::{COSTS, best_of_settings, curve_plots, forest_figure};
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "bound",
    title: "The bound",
    question: "How much could any kd-tree gain, if it knew the rays and were built without greed?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    if !study.has("bound") {
        return None;
    }
    let pairs = study.totals("bound");
    let curves: Vec<&Curve> = study.records_of("bound").flat_map(|r| &r.curves).collect();
    let bounds = bounds(&curves);
    let findings = quantities(&bounds).into_iter().filter_map(|q| finding(q, &bounds)).collect::<Vec<_>>();
    let findings =
        if findings.is_empty() { best_of_settings(&pairs, Metric::Steps).into_iter().collect() } else { findings };
    let caption = html! { "How far each tree is from the greedy tree by areas, means over scenes: the least is the bound that was found." };
    let body = html! {
        @if !bounds.is_empty() {
            (forest_figure(&entries(&bounds), "ratio to the base: left of 1 is better", &caption))
            (bounds_table(&bounds))
        }
        @if !pairs.is_empty() { (effects("Towards the bound", &pairs, &[Key::Setting, Key::Spec, Key::Base], &COSTS)) }
        (curve_plots(&curves))
    };
    Some(Section { findings, body })
}

/// A quantity, a tree, and what it is relative to the base.
struct Bound {
    quantity: String,
    tree: String,
    effect: Effect,
}

/// Curves of single points, named `quantity: tree`, over all scenes.
fn bounds(curves: &[&Curve]) -> Vec<Bound> {
    let mut order: Vec<&str> = Vec::new();
    let mut named: BTreeMap<&str, Vec<(&str, f64)>> = BTreeMap::new();
    for curve in curves.iter().filter(|c| c.points.len() == 1) {
        if !order.contains(&curve.name.as_str()) {
            order.push(&curve.name);
        }
        named.entry(&curve.name).or_default().push((&curve.scene, curve.points[0][1]));
    }
    let bound = |name: &str| {
        let (quantity, tree) = name.split_once(": ").unwrap_or(("", name));
        let effect = Effect::of_ratios(named.get(name)?.iter().copied())?;
        Some(Bound { quantity: quantity.to_owned(), tree: tree.to_owned(), effect })
    };
    order.into_iter().filter_map(bound).collect()
}

fn quantities(bounds: &[Bound]) -> Vec<&str> {
    let mut quantities: Vec<&str> = Vec::new();
    for bound in bounds {
        if !quantities.contains(&bound.quantity.as_str()) {
            quantities.push(&bound.quantity);
        }
    }
    quantities
}

fn finding(quantity: &str, bounds: &[Bound]) -> Option<Markup> {
    let best =
        bounds.iter().filter(|b| b.quantity == quantity).min_by(|a, b| a.effect.mean.total_cmp(&b.effect.mean))?;
    Some(html! {
        @if !quantity.is_empty() { (quantity) ": " } "the best tree found, “" (best.tree) "”, is at " (words::figures(&best.effect)) " of the base, over "
        (words::count(best.effect.scenes, "scene"))
    })
}

fn entries(bounds: &[Bound]) -> Vec<Entry> {
    let mut entries = Vec::new();
    for quantity in quantities(bounds) {
        if !quantity.is_empty() {
            entries.push(Entry::Head(quantity.to_owned()));
        }
        let inside = bounds.iter().filter(|b| b.quantity == quantity);
        entries.extend(inside.map(|b| Entry::Mean { label: b.tree.clone(), series: 0, effect: b.effect }));
    }
    entries
}

fn bounds_table(bounds: &[Bound]) -> Markup {
    let row = |b: &Bound| {
        let e = &b.effect;
        vec![
            html! { (b.quantity) },
            html! { (b.tree) },
            html! { (e.n) },
            ratio(e),
            html! { (words::digits(e.least)) },
            html! { (words::digits(e.most)) },
        ]
    };
    let heads = ["quantity", "tree", ">cases", ">ratio", ">least", ">most"];
    table("The bound, and what is on the way to it", &heads, &bounds.iter().map(row).collect::<Vec<_>>())
}
