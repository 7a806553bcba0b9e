//! The main result at a glance, for the summary.

use maud::{Markup, html};

use super::super::svg::Entry;
use super::super::table::{Key, group};
use super::super::view::{Study, ours};
use super::common::{COSTS, effect, forest_figure};

/// Steps, tests and time of our own heuristic, by the rays that were cast.
pub(in crate::report) fn glance(study: &Study<'_>) -> Markup {
    let pairs = study.ours();
    let Some(first) = pairs.first() else { return html! {} };
    let mut entries = Vec::new();
    for metric in COSTS {
        entries.push(Entry::Head(metric.name().to_owned()));
        for mode in group(&pairs, &[Key::Mode]) {
            if let Some(effect) = effect(&mode.pairs, metric) {
                entries.push(Entry::Mean { label: mode.labels[0].clone(), series: 0, effect });
            }
        }
    }
    let caption = html! {
        "What " code { (ours()) } " takes relative to " code { (first.base) } ", by the rays that were cast: means over all views with 95\u{a0}% intervals."
    };
    forest_figure(&entries, "ratio to the base: left of 1 is better", &caption)
}
