//! SAH's two assumptions, taken apart.

use maud::html;

use super::super::pairs::Metric;
use super::super::table::{Key, effects, legend};
use super::super::view::Study;
use super::super::words;
use super::common::{COSTS, curve_plots, effect, forest_of};
use super::{Chapter, Section};
use crate::study::Curve;

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
    let findings = super::super::table::group(&pairs, &[Key::Setting, Key::Spec]).into_iter().filter_map(|g| {
        let steps = effect(&g.pairs, Metric::Steps)?;
        let name = if g.labels[0].is_empty() { g.labels[1].clone() } else { g.labels[0].clone() };
        Some(html! { "Trained on " (name) ": " (words::said(&steps, Metric::Steps)) " than by areas" })
    });
    let findings = findings.collect();
    let curves: Vec<&Curve> = study.records_of("assumptions").flat_map(|r| &r.curves).collect();
    let caption = html! { "Trees from different training rays, all cast with the same real test rays; steps relative to the base." };
    let body = html! {
        @if !pairs.is_empty() {
            (forest_of(study, &pairs, [Key::Spec, Key::Setting], Metric::Steps, &caption))
            (effects("By the rays that the tree was built from", &pairs, &[Key::Setting, Key::Spec, Key::Base], &COSTS))
            (legend())
        }
        (curve_plots(&curves))
    };
    Some(Section { findings, body })
}
