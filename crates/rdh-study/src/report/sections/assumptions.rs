//! SAH's two assumptions, taken apart.

use maud::html;

use super::super::pairs::Metric;
use super::super::table::{Key, effects};
use super::super::view::Study;
use super::common::{COSTS, best_of_settings, forest_of};
use super::curves::curve_plots;
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "assumptions",
    title: "Two assumptions, taken apart",
    question: "Areas assume that rays are spread evenly, and that nothing stops them. What does each assumption cost?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    if !study.has("assumptions") {
        return None;
    }
    let pairs = study.totals("assumptions");
    let findings = best_of_settings(&pairs, Metric::Steps).into_iter().collect();
    let curves: Vec<&Curve> = study.records_of("assumptions").flat_map(|r| &r.curves).collect();
    let caption = html! { "Trees from different training rays, all cast with the same real test rays; steps relative to the base." };
    let body = html! {
        @if !pairs.is_empty() {
            (forest_of(study, &pairs, [Key::Base, Key::Setting], Metric::Steps, &caption))
            (effects("By the rays that the tree was built from", &pairs, &[Key::Setting, Key::Spec, Key::Base], &COSTS))
        }
        (curve_plots(study, &curves))
    };
    Some(Section { findings, body })
}
