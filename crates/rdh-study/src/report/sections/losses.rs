//! Where it loses: every pair that is surely slower.

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::table;
use super::super::view::Study;
use super::super::words::{self, digits};
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "losses",
    title: "Where it loses",
    question: "Which views are slower with the rays known than without?",
    write,
};

/// More lines than this are no table but a listing: the worst of them are shown.
const MOST: usize = 60;

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs: Vec<&Pair<'_>> = study.main().into_iter().filter(|p| p.class.is_none()).collect();
    if pairs.is_empty() {
        return None;
    }
    let mut losses: Vec<(f64, [f64; 2], &Pair<'_>)> = pairs.iter().filter_map(|p| loss(p)).collect();
    losses.sort_by(|a, b| b.0.total_cmp(&a.0));
    let finding = match losses.len() {
        0 => html! { "None of " (words::count(pairs.len(), "pair")) " is surely slower than its base" },
        n => {
            html! { (n) " of " (words::count(pairs.len(), "pair")) " are surely slower than their base: the interval over their own rounds lies wholly above 1" }
        }
    };
    let rows: Vec<Vec<Markup>> = losses.iter().take(MOST).map(row).collect();
    let body = html! {
        @if !rows.is_empty() {
            (table("Surely slower, the worst first", &["view", "kind", "rays", "spec", ">time", ">95\u{a0}% interval", ">steps", ">tests"], &rows))
        }
        @if losses.len() > MOST { p.note { "The worst " (MOST) " of " (losses.len()) "; the others are in the study’s rows." } }
    };
    Some(Section { findings: vec![finding], body })
}

fn loss<'p, 'r>(pair: &'p Pair<'r>) -> Option<(f64, [f64; 2], &'p Pair<'r>)> {
    let interval = pair.time_interval().filter(|i| i[0] > 1.0)?;
    Some((pair.ratio(Metric::Time)?, interval, pair))
}

fn row((time, [low, high], pair): &(f64, [f64; 2], &Pair<'_>)) -> Vec<Markup> {
    let ratio = |metric| pair.ratio(metric).map_or("–".to_owned(), digits);
    vec![
        html! { code { (pair.place()) } },
        html! { (words::kind(pair.kind)) },
        html! { (pair.job.mode) },
        html! { code { (pair.spec) } },
        html! { (digits(*time)) },
        html! { (digits(*low)) "–" (digits(*high)) },
        html! { (ratio(Metric::Steps)) },
        html! { (ratio(Metric::Tests)) },
    ]
}
