//! Controls: the same effort with areas instead of rays.

use maud::html;

use super::super::pairs::Metric;
use super::super::table::{Key, effects};
use super::super::view::Study;
use super::common::{COSTS, best_of_settings, forest_of};
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
    let findings = [Metric::Steps, Metric::Time].into_iter().filter_map(|m| best_of_settings(&pairs, m)).collect();
    let caption = html! { "Time of the controls, relative to the base." };
    let metrics: Vec<Metric> = COSTS.into_iter().chain([Metric::Build, Metric::Bytes]).collect();
    let body = html! {
        (forest_of(study, &pairs, [Key::Setting, Key::Spec], Metric::Time, &caption))
        (effects("Controls", &pairs, &[Key::Setting, Key::Spec, Key::Base], &metrics))
    };
    Some(Section { findings, body })
}
