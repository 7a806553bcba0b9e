//! What could any tree gain?

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects, group, legend};
use super::super::view::Study;
use super::super::words;
use super::common::{curve_plots, effect, forest_of};
use super::{Chapter, Section};
use crate::study::Curve;

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
    let findings =
        group(&pairs, &[Key::Setting, Key::Spec]).iter().filter_map(|g| finding(&g.labels, &g.pairs)).collect();
    let caption = html! { "Steps towards the bound, relative to the base." };
    let body = html! {
        @if !pairs.is_empty() {
            (forest_of(study, &pairs, [Key::Setting, Key::Spec], Metric::Steps, &caption))
            (effects("Towards the bound", &pairs, &[Key::Setting, Key::Spec, Key::Base], &[Metric::Steps, Metric::Tests]))
            (legend())
        }
        (curve_plots(&curves))
    };
    Some(Section { findings, body })
}

fn finding(labels: &[String], pairs: &[&Pair<'_>]) -> Option<Markup> {
    let said = [Metric::Steps, Metric::Tests].into_iter().filter_map(|m| Some(words::said(&effect(pairs, m)?, m)));
    let said: Vec<String> = said.collect();
    Some(html! { (labels[0]) ", " code { (labels[1]) } ": " (words::list(&said)) })
}
