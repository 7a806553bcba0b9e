//! How many training rays are enough.

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects};
use super::super::view::{Study, ours};
use super::super::words::{self, digits, percent};
use super::common::{COSTS, effect, lines_over_x, points};
use super::curves::curve_plots;
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "how-many",
    title: "How many rays are enough",
    question: "How many training rays does the gain need, and how far is it from that of a tree which is trained on the test rays themselves?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("how-many");
    if pairs.is_empty() {
        return None;
    }
    let findings = [enough(&pairs), gap(&pairs)].into_iter().flatten().collect();
    let caption = |m: Metric| html! { "Generalisation: " (m.name()) " with unseen test rays over the number of training rays, relative to the base." };
    let across = "training rays";
    let curves: Vec<&Curve> = study.records_of("how-many").flat_map(|r| &r.curves).collect();
    let body = html! {
        (lines_over_x(study, &pairs, Metric::Steps, across, &caption(Metric::Steps)))
        (lines_over_x(study, &pairs, Metric::Time, across, &caption(Metric::Time)))
        (curve_plots(study, &curves))
        (effects("By the number of training rays", &pairs, &[Key::Setting, Key::Spec], &COSTS))
    };
    Some(Section { findings, body })
}

/// The fewest rays that give nine tenths of the largest gain in steps.
fn enough(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let mine: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.spec == ours() && !is_bound(p)).collect();
    let points = points(&mine, Metric::Steps);
    let best = points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    if best >= 1.0 || points.len() < 2 {
        return None;
    }
    let enough = points.iter().find(|p| 1.0 - p[1] >= 0.9 * (1.0 - best))?;
    Some(html! {
        (words::grouped(enough[0])) " training rays give nine tenths of the largest gain in steps that any number gave ("
        (digits(enough[1])) " against " (digits(best)) ")"
    })
}

fn gap(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let bound: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.spec == ours() && is_bound(p)).collect();
    let mine: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.spec == ours() && !is_bound(p)).collect();
    let (bound, most) = (effect(&bound, Metric::Steps)?, *points(&mine, Metric::Steps).last()?);
    Some(html! {
        "Trained on the very rays that are counted, which no sample can beat, the steps’ ratio is " (digits(bound.mean)) "; with "
        (words::grouped(most[0])) " other rays it is " (digits(most[1])) ", a gap of " (percent(most[1] / bound.mean - 1.0))
    })
}

/// Trained on the test rays: that has no number.
fn is_bound(pair: &Pair<'_>) -> bool {
    pair.x.is_none()
}
