//! Where the training rays come from.

use maud::html;

use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects};
use super::super::view::Study;
use super::common::{COSTS, best_of_settings, curve_plots, forest_of, lines_over_x};
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "which-rays",
    title: "Whose rays they are",
    question: "This frame’s rays must be paid for, the previous frame’s are there already, another view’s are others: what is left of the gain?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("which-rays");
    if pairs.is_empty() {
        return None;
    }
    let findings = [Metric::Steps, Metric::Time].into_iter().filter_map(|m| best_of_settings(&pairs, m)).collect();
    let far: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.x.is_some()).collect();
    let decay = html! { "Decay: steps over how many frames lie between the training rays and the test rays, relative to the base." };
    let sources = html! { "Steps by the source of the training rays, relative to the base." };
    let metrics: Vec<Metric> = COSTS.into_iter().chain([Metric::Worst, Metric::BuildAndRays]).collect();
    let curves: Vec<&Curve> = study.records_of("which-rays").flat_map(|r| &r.curves).collect();
    let body = html! {
        @if !far.is_empty() { (lines_over_x(study, &far, Metric::Steps, "frames between them", &decay)) }
        (forest_of(study, &pairs, [Key::Spec, Key::Setting], Metric::Steps, &sources))
        (effects("By the source of the training rays", &pairs, &[Key::Setting, Key::Spec, Key::Base], &metrics))
        (curve_plots(&curves))
    };
    Some(Section { findings, body })
}
