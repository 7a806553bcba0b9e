//! Controls: the same effort with areas instead of rays.

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects, group, legend};
use super::super::view::Study;
use super::super::words;
use super::common::{COSTS, effect, forest_of};
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "controls",
    title: "Controls",
    question: "Is it the rays that help, or only the effort: another stop rule, more pruning, counting as such?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("controls");
    if pairs.is_empty() {
        return None;
    }
    let findings =
        group(&pairs, &[Key::Setting, Key::Spec]).iter().filter_map(|g| finding(&g.labels, &g.pairs)).collect();
    let caption = html! { "Time of the controls, relative to the base." };
    let metrics: Vec<Metric> = COSTS.into_iter().chain([Metric::Build, Metric::Bytes]).collect();
    let body = html! {
        (forest_of(study, &pairs, [Key::Setting, Key::Spec], Metric::Time, &caption))
        (effects("Controls", &pairs, &[Key::Setting, Key::Spec, Key::Base], &metrics))
        (legend())
    };
    Some(Section { findings, body })
}

fn finding(labels: &[String], pairs: &[&Pair<'_>]) -> Option<Markup> {
    let (steps, time) = (effect(pairs, Metric::Steps)?, effect(pairs, Metric::Time)?);
    let place = if labels[0].is_empty() { String::new() } else { format!("{}, ", labels[0]) };
    Some(html! {
        (place) code { (labels[1]) } ": " (words::said(&steps, Metric::Steps)) " and " (words::said(&time, Metric::Time))
    })
}
