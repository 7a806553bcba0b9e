//! How rays and areas are mixed.

use maud::html;

use super::super::pairs::Metric;
use super::super::table::{Key, effects};
use super::super::view::Study;
use super::super::words::{digits, percent};
use super::common::{COSTS, families, lines_of, lines_over_x};
use super::{Chapter, Section};
use crate::report::svg::Line;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "blend",
    title: "How rays and areas are mixed",
    question: "The paper blends the rays’ chances with the areas’, and its poster gives no weights. Does the weight matter?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("blend");
    if pairs.is_empty() {
        return None;
    }
    let lines =
        families(&pairs).into_iter().flat_map(|(family, pairs)| lines_of(study, &family, &pairs, Metric::Steps));
    let findings = lines.filter_map(|line| finding(&line)).collect();
    let caption = |m: Metric| html! { (m.name()) " over the parameter of the blend, relative to the base; bands are 95\u{a0}% intervals." };
    let body = html! {
        (lines_over_x(study, &pairs, Metric::Steps, "parameter of the blend", &caption(Metric::Steps)))
        (effects("By the blend", &pairs, &[Key::Setting, Key::Spec], &COSTS))
    };
    Some(Section { findings, body })
}

fn finding(line: &Line) -> Option<maud::Markup> {
    let best = line.points.iter().min_by(|a, b| a[1].total_cmp(&b[1]))?;
    let worst = line.points.iter().max_by(|a, b| a[1].total_cmp(&b[1]))?;
    (line.points.len() > 1).then(|| {
        html! {
            "“" (line.name) "”: the steps’ ratio is best at " (digits(best[0])) " (" (digits(best[1])) ") and worst at " (digits(worst[0])) " ("
            (digits(worst[1])) "): the parameter decides over " (percent(worst[1] / best[1] - 1.0)) " of the steps"
        }
    })
}
