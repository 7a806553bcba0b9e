//! Where it loses: every pair that is surely slower.

use maud::{Markup, html};

use super::super::group::{Key, group};
use super::super::pairs::{Metric, Pair};
use super::super::table::table;
use super::super::view::{Study, ours};
use super::super::words::{self, digits};
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "losses",
    title: "Where it loses",
    question: "Which views are slower with the rays known than without?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs: Vec<&Pair<'_>> = study.main().into_iter().filter(|p| p.class.is_none()).collect();
    if pairs.is_empty() {
        return None;
    }
    let mut specs = group(&pairs, &[Key::Spec]);
    specs.sort_by_key(|g| study.series(&g.pairs[0].spec));
    let findings = specs.iter().map(|g| finding(&g.labels[0], &g.pairs)).collect();
    let rows: Vec<Vec<Markup>> = losses(&study.ours()).iter().map(row).collect();
    let caption = format!("All views in which {} is surely slower, the worst first", ours());
    let heads = ["view", "kind", "rays", ">time", ">95\u{a0}% interval", ">steps", ">tests"];
    let body = html! { @if !rows.is_empty() { (table(&caption, &heads, &rows)) } };
    Some(Section { findings, body })
}

fn finding(spec: &str, pairs: &[&Pair<'_>]) -> Markup {
    html! {
        code { (spec) } " is surely slower in " (losses(pairs).len()) " of " (words::count(pairs.len(), "pair"))
        ": the interval over their own rounds lies wholly above 1"
    }
}

/// Ratio and interval of each pair that is surely slower.
fn losses<'p, 'r>(pairs: &[&'p Pair<'r>]) -> Vec<(f64, [f64; 2], &'p Pair<'r>)> {
    let loss = |pair: &&'p Pair<'r>| {
        let interval = pair.time_interval().filter(|i| i[0] > 1.0)?;
        Some((pair.ratio(Metric::Time)?, interval, *pair))
    };
    let mut losses: Vec<_> = pairs.iter().filter_map(loss).collect();
    losses.sort_by(|a, b| b.0.total_cmp(&a.0));
    losses
}

fn row((time, [low, high], pair): &(f64, [f64; 2], &Pair<'_>)) -> Vec<Markup> {
    let ratio = |metric| pair.ratio(metric).map_or("–".to_owned(), digits);
    vec![
        html! { code { (pair.place()) } },
        html! { (words::kind(pair.kind)) },
        html! { (pair.job.mode) },
        html! { (digits(*time)) },
        html! { (digits(*low)) "–" (digits(*high)) },
        html! { (ratio(Metric::Steps)) },
        html! { (ratio(Metric::Tests)) },
    ]
}
