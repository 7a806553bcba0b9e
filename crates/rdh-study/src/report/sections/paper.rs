//! The paper's two rows, and ours beside them.

use maud::{Markup, html};

use super::super::effect::Effect;
use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, against, group, ratio, table};
use super::super::view::{Study, ours};
use super::super::words::{self, signed};
use super::common::{costs_said, effect};
use super::{Chapter, Section};
use crate::integrate::Mode;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "paper",
    title: "The paper’s rows, and ours",
    question: "Do the figures of Bittner and Havran (2009) come out again, by their protocol and their rule of termination?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("paper");
    if pairs.is_empty() {
        return None;
    }
    let findings = [Mode::Primary, Mode::Whitted].into_iter().filter_map(|mode| finding(&pairs, mode)).collect();
    let body = html! {
        p {
            "The paper reports, over 28 scenes and 52 views that it does not name, for ray casting 8\u{a0}% fewer tests, 2\u{a0}% fewer steps and up "
            "to 5\u{a0}% less time; for ray tracing no improvement, on average a small slowdown. Its rule is rebuilt here as "
            code { "kd(stop=paper,prune=none)" } "; the training rays are a subset of the very frame that is counted."
        }
        (rows(&pairs))
    };
    Some(Section { findings, body })
}

fn finding(pairs: &[&Pair<'_>], mode: Mode) -> Option<Markup> {
    let theirs: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.job.mode == mode && is_the_papers(p)).collect();
    let first = theirs.first()?;
    let name = if mode == Mode::Primary { "Ray casting" } else { "Ray tracing" };
    let paper = if mode == Mode::Primary {
        "the paper: −8\u{a0}% tests, −2\u{a0}% steps, up to −5\u{a0}% time"
    } else {
        "the paper: no gain, a small slowdown"
    };
    let scenes = Effect::of(theirs.iter().copied(), Metric::Steps)?.scenes;
    Some(html! {
        (name) " by the paper’s heuristic under the paper’s rule: " (costs_said(&theirs)) " against " code { (first.base) } ", in "
        (words::count(theirs.len(), "view")) " of " (words::count(scenes, "scene")) " (" (paper) ")"
    })
}

/// The paper's heuristic against areas under the rule of its authors.
fn is_the_papers(pair: &Pair<'_>) -> bool {
    pair.spec.to_string().contains("rdh(paper)") && pair.base.to_string().contains("stop=paper")
}

fn rows(pairs: &[&Pair<'_>]) -> Markup {
    let mut rows = Vec::new();
    for mode in [Mode::Primary, Mode::Whitted] {
        let here: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.job.mode == mode).collect();
        if here.is_empty() {
            continue;
        }
        rows.push(vec![
            html! { @if mode == Mode::Primary { "ray casting: primary rays" } @else { "ray tracing: all rays" } },
        ]);
        rows.push(published(mode));
        for g in group(&here, &[Key::Setting, Key::Base, Key::Spec]) {
            rows.push(row(&g.pairs));
        }
    }
    let heads = ["spec", ">views", ">tests", ">steps", ">time", ">best", ">worst", ">slower"];
    table(
        "Ray casting and ray tracing: the paper’s figures, and ours; best and worst are the times of single views",
        &heads,
        &rows,
    )
}

fn published(mode: Mode) -> Vec<Markup> {
    let [tests, steps, time, best] = match mode {
        Mode::Primary => ["0.92", "0.98", "–", "−5\u{a0}%"],
        _ => ["no gain", "no gain", "a little more", "–"],
    };
    let cell = |words: &str| html! { span.published { (words) } };
    let plain = |words: &str| html! { (words) };
    vec![
        html! { span.published { "as published" } span.interval { "against SAH" } },
        cell("52"),
        cell(tests),
        cell(steps),
        cell(time),
        cell(best),
        plain(""),
        plain(""),
    ]
}

fn row(pairs: &[&Pair<'_>]) -> Vec<Markup> {
    let of = |metric| effect(pairs, metric);
    let mean = |metric| of(metric).map_or_else(|| html! { "–" }, |e| ratio(&e));
    let time = of(Metric::Time);
    let end = |value: fn(&Effect) -> f64| html! { @if let Some(e) = &time { (signed(value(e))) } };
    let first = pairs[0];
    let strong = is_the_papers(first) || first.spec == ours();
    vec![
        html! {
            @if strong { strong { code { (first.spec) } } } @else { code { (first.spec) } }
            (against(&first.base))
        },
        html! { (pairs.len()) },
        mean(Metric::Tests),
        mean(Metric::Steps),
        mean(Metric::Time),
        end(|e| e.least),
        end(|e| e.most),
        html! { @if let Some(e) = &time { (e.losses) } },
    ]
}
