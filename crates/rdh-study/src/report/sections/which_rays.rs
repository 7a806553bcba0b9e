//! Where the training rays come from.

use maud::{Markup, html};

use super::super::figure::figure;
use super::super::pairs::{Metric, Pair};
use super::super::svg::{Dot, scatter};
use super::super::table::{Key, effects, group};
use super::super::view::Study;
use super::super::words::{self, digits, percent};
use super::common::{COSTS, effect, families, forest_of, lines_over_x, points};
use super::curves::curve_plots;
use super::{Chapter, Section};
use crate::rows::Curve;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "which-rays",
    title: "Whose rays they are",
    question: "This frame’s rays must be paid for, the previous frame’s are there already, another view’s are others: what is left of the gain?",
    write,
};

/// Names of curves that say whether a rule chose well begin so; each point is 1 if it did.
const RULE: &str = "rule: ";

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("which-rays");
    if pairs.is_empty() {
        return None;
    }
    let curves: Vec<&Curve> = study.records_of("which-rays").flat_map(|r| &r.curves).collect();
    let (known, others): (Vec<&Curve>, Vec<&Curve>) = curves.into_iter().partition(|c| c.across.starts_with("part of"));
    let (rules, ratios): (Vec<&Curve>, Vec<&Curve>) = known.into_iter().partition(|c| c.name.starts_with(RULE));
    let decays = families(&pairs).into_iter().filter_map(|(name, pairs)| decay(&name, &pairs));
    let findings = sources(&pairs).into_iter().chain(decays).chain(judged(&rules)).collect();
    let decay =
        html! { "Steps over how many frames lie between the training rays and the test rays, relative to the base." };
    let caption = html! { "Steps by the source of the training rays, relative to the base." };
    let metrics: Vec<Metric> = COSTS.into_iter().chain([Metric::BuildAndRays, Metric::Frame]).collect();
    let body = html! {
        (lines_over_x(study, &pairs, Metric::Steps, "frames between them", &decay))
        (forest_of(study, &pairs, [Key::Spec, Key::Setting], Metric::Steps, &caption))
        (effects("By the source of the training rays", &pairs, &[Key::Setting, Key::Spec, Key::Base], &metrics))
        p.note { "“build + rays” has the acquisition of the training rays in it; “whole frame” the casting of all test rays, too." }
        (known_plot(&ratios))
        (curve_plots(study, &others))
    };
    Some(Section { findings, body })
}

/// Sources without a distance, one by one.
fn sources(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let at_rest: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.x.is_none()).collect();
    let said = |g: &super::super::table::Group<'_, '_>| {
        Some(format!("{}: {}", g.labels[0], words::said(&effect(&g.pairs, Metric::Steps)?, Metric::Steps)))
    };
    let said: Vec<String> = group(&at_rest, &[Key::Setting]).iter().filter_map(said).collect();
    (!said.is_empty()).then(|| html! { (words::capital(&said.join("; "))) })
}

/// What is left of the gain from the nearest to the farthest.
fn decay(family: &str, pairs: &[&Pair<'_>]) -> Option<Markup> {
    let points = points(pairs, Metric::Steps);
    let [near, .., far] = points.as_slice() else { return None };
    Some(html! {
        (words::capital(family)) ": the steps’ ratio goes from " (digits(near[1])) " (" (digits(near[2])) "–" (digits(near[3])) ") at " (near[0]) " to "
        (digits(far[1])) " (" (digits(far[2])) "–" (digits(far[3])) ") at " (far[0])
    })
}

/// How often each rule chose the cheaper tree.
fn judged(rules: &[&Curve]) -> Option<Markup> {
    let mut names: Vec<&str> = rules.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let said = |name: &&str| {
        let points: Vec<f64> = rules.iter().filter(|c| c.name == *name).flat_map(|c| &c.points).map(|p| p[1]).collect();
        let right = points.iter().sum::<f64>();
        let rule = name.trim_start_matches(RULE).split(';').next().unwrap_or_default();
        let share = percent(right / points.len() as f64);
        (!points.is_empty()).then(|| format!("“{rule}” is right in {right:.0} of {} cases ({share})", points.len()))
    };
    let said: Vec<String> = names.iter().filter_map(said).collect();
    (!said.is_empty()).then(|| html! { "When to fall back to areas: " (words::list(&said)) })
}

/// Gain over how much of the new rays' way was known.
fn known_plot(ratios: &[&Curve]) -> Markup {
    let Some(first) = ratios.first() else { return html! {} };
    let dot = |c: &&Curve, p: &[f64; 3]| Dot {
        x: p[0],
        y: p[1],
        series: 0,
        says: format!("{}:{} {}: {:.3} at {:.2}", c.scene, c.view, c.mode, p[1], p[0]),
    };
    let dots: Vec<Dot> =
        ratios.iter().flat_map(|c| c.points.iter().filter(|p| p[1] > 0.0).map(move |p| dot(c, p))).collect();
    let labels = [first.across.as_str(), first.name.as_str()];
    let says = format!("Scatter plot: {} over {}", first.name, first.across);
    let caption = html! { "What the tree costs over how much its training rays know of the new ones; one mark a source and view." };
    figure(&caption, &[], |width| scatter(&dots, labels, &says, width))
}
