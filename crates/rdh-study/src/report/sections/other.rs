//! Experiments that have no section of their own: their effects as tables.

use maud::html;

use super::super::group::Key;
use super::super::pairs::Metric;
use super::super::table::effects;
use super::super::view::Study;
use super::common::COSTS;
use super::curves::curve_plots;
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter { id: "other", title: "Other experiments", question: "", write };

const KNOWN: [&str; 13] = [
    "paper",
    "modes",
    "assumptions",
    "which-rays",
    "how-many",
    "blend",
    "termination",
    "frames",
    "occlusion",
    "controls",
    "bound",
    "aa",
    "spd",
];

fn write(study: &Study<'_>) -> Option<Section> {
    let names: Vec<&str> = study.experiments().into_iter().filter(|n| !KNOWN.contains(n)).collect();
    if names.is_empty() {
        return None;
    }
    let metrics: Vec<Metric> = COSTS.into_iter().chain([Metric::Build, Metric::Bytes]).collect();
    let body = html! {
        @for name in names {
            @let curves = study.records_of(name).flat_map(|r| &r.curves).collect::<Vec<&Curve>>();
            h3 { (name) }
            (effects(name, &study.totals(name), &[Key::Mode, Key::Setting, Key::Spec, Key::Base], &metrics))
            (curve_plots(study, &curves))
        }
    };
    Some(Section { findings: Vec::new(), body })
}
