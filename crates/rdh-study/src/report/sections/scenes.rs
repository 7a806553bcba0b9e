//! The scenes: kind, size, depth complexity, and what was gained in each.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::table;
use super::super::view::Study;
use super::super::words::{self, digits, grouped};
use super::common::effect;
use super::{Chapter, Section};
use crate::rows::Row;
use crate::stats::geometric_mean;

pub(super) const CHAPTER: Chapter = Chapter { id: "scenes", title: "The scenes", question: "", write };

fn write(study: &Study<'_>) -> Option<Section> {
    let mut scenes: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in study.records.iter().flat_map(|r| &r.rows) {
        scenes.entry((words::kind(row.kind), &row.scene)).or_default().push(row);
    }
    if scenes.is_empty() {
        return None;
    }
    let gains = study.ours();
    let rows: Vec<Vec<Markup>> = scenes.iter().map(|(key, rows)| row(*key, rows, &gains)).collect();
    let heads = ["kind", "scene", ">triangles", ">views", ">depth complexity", ">steps", ">tests", ">time"];
    let body = html! {
        (table("Every scene: what it is, and what knowing the rays gives in it", &heads, &rows))
        p.note { "Depth complexity: surfaces along a primary ray, mean over the views it was measured in. Steps, tests and time: ratios to the base, all kinds of rays." }
    };
    Some(Section { findings: Vec::new(), body })
}

fn row((kind, scene): (&str, &str), rows: &[&Row], gains: &[&Pair<'_>]) -> Vec<Markup> {
    let mut views: Vec<(&str, u32)> = rows.iter().map(|r| (r.view.as_str(), r.frame)).collect();
    views.sort_unstable();
    views.dedup();
    let depths: Vec<f64> = rows.iter().filter_map(|r| r.depth_complexity).filter(|d| *d > 0.0).collect();
    let depth = if depths.is_empty() { "–".to_owned() } else { format!("{:.1}", geometric_mean(&depths)) };
    let here: Vec<&Pair<'_>> = gains.iter().copied().filter(|p| p.job.scene == scene).collect();
    let ratio = |metric| effect(&here, metric).map_or("–".to_owned(), |e| digits(e.mean));
    let mut cells = vec![html! { (kind) }, html! { code { (scene) } }];
    let triangles = grouped(rows.iter().map(|r| r.triangles).max().unwrap_or(0) as f64);
    let numbers =
        [triangles, views.len().to_string(), depth, ratio(Metric::Steps), ratio(Metric::Tests), ratio(Metric::Time)];
    cells.extend(numbers.into_iter().map(|n| html! { (n) }));
    cells
}
