//! By kind of scene, and with every kind counting alike.

use maud::{Markup, html};
use rdh_scene::Kind;

use super::super::effect::Effect;
use super::super::figure::figure;
use super::super::pairs::{Metric, Pair};
use super::super::svg::{Dot, strip};
use super::super::table::{Key, group, ratio, table};
use super::super::view::{Study, ours};
use super::super::words;
use super::common::{COSTS, axis_of, effect};
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "kinds",
    title: "By kind of scene",
    question: "Most scenes of the procedural databases are open: does a mean over them hide what happens where much is hidden?",
    write,
};

const KINDS: [Kind; 3] = [Kind::Open, Kind::Interior, Kind::Dense];

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.ours();
    if pairs.is_empty() {
        return None;
    }
    let body = html! {
        (strip_of(&pairs, Metric::Steps))
        (strip_of(&pairs, Metric::Time))
        (by_kind(&pairs))
        (lone_kinds(&pairs))
    };
    Some(Section { findings: finding(&pairs).into_iter().collect(), body })
}

fn finding(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let of = |kind: Kind| effect(&pairs.iter().copied().filter(|p| p.kind == kind).collect::<Vec<_>>(), Metric::Steps);
    let said = KINDS
        .into_iter()
        .filter_map(|kind| Some(format!("{} in {} scenes", words::said(&of(kind)?, Metric::Steps), words::kind(kind))));
    let said: Vec<String> = said.collect();
    let weighted = Effect::by_kind(pairs.iter().copied(), Metric::Time)?;
    Some(html! {
        "Over all rays: " (words::list(&said)) "; with every kind counting alike, " (words::said(&weighted, Metric::Time))
    })
}

fn strip_of(pairs: &[&Pair<'_>], metric: Metric) -> Markup {
    let groups: Vec<(String, Vec<Dot>)> = KINDS.into_iter().filter_map(|kind| dots(pairs, kind, metric)).collect();
    let says = format!("Strip plot of {}, one dot a view and mode, by kind of scene", axis_of(metric));
    let caption = html! { "Every view and mode as one dot, by kind of scene: " (metric.name()) " of " code { (ours()) } ". Pointing at a dot names it." };
    figure(&caption, &[], |width| strip(&groups, &axis_of(metric), &says, width))
}

fn dots(pairs: &[&Pair<'_>], kind: Kind, metric: Metric) -> Option<(String, Vec<Dot>)> {
    let dot = |p: &&Pair<'_>| {
        let y = p.ratio(metric)?;
        Some(Dot { x: 0.0, y, series: kind as usize, says: format!("{} {}: {y:.3}", p.place(), p.job.mode) })
    };
    let dots: Vec<Dot> = pairs.iter().filter(|p| p.kind == kind).filter_map(dot).collect();
    let name = format!("{}, {}", words::kind(kind), words::count(dots.len(), "pair"));
    (!dots.is_empty()).then_some((name, dots))
}

/// What an interval can't know.
fn lone_kinds(pairs: &[&Pair<'_>]) -> Markup {
    let lone = group(pairs, &[Key::Kind]).into_iter().filter(|g| {
        let first = &g.pairs[0].job.scene;
        g.pairs.iter().all(|p| p.job.scene == *first)
    });
    let lone: Vec<String> =
        lone.map(|g| format!("{} scenes are but one, {}", g.labels[0], g.pairs[0].job.scene)).collect();
    html! {
        @if !lone.is_empty() {
            p.note { (words::capital(&words::list(&lone))) ": intervals know how its views differ, not how scenes of this kind would." }
        }
    }
}

/// A line for each kind, and one in which they count alike.
fn by_kind(pairs: &[&Pair<'_>]) -> Markup {
    let mut rows = Vec::new();
    for mode in group(pairs, &[Key::Mode]) {
        let kinds = group(&mode.pairs, &[Key::Kind]);
        rows.push(vec![html! { (mode.labels[0]) }]);
        for kind in &kinds {
            let of = |metric| Effect::of(kind.pairs.iter().copied(), metric);
            rows.push(row(&kind.labels[0], kind.pairs.len(), of));
        }
        if kinds.len() > 1 {
            rows.push(row("each kind alike", mode.pairs.len(), |metric| {
                Effect::by_kind(mode.pairs.iter().copied(), metric)
            }));
        }
    }
    let heads = ["kind of scene", ">pairs", ">steps", ">tests", ">time", ">slower"];
    table(&format!("{} by kind of scene", ours()), &heads, &rows)
}

fn row(kind: &str, n: usize, of: impl Fn(Metric) -> Option<Effect>) -> Vec<Markup> {
    let losses = of(Metric::Time).map_or(0, |e| e.losses);
    let mut row = vec![html! { (kind) }, html! { (n) }];
    row.extend(COSTS.map(|m| of(m).map_or_else(|| html! { "–" }, |e| ratio(&e))));
    row.push(html! { (losses) });
    row
}
