//! When to stop: the same rules for both, pruning, and leaving alone what no ray reaches.

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects, group};
use super::super::view::Study;
use super::super::words;
use super::common::{effect, forest_of};
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "termination",
    title: "When to stop",
    question: "The paper says that large occluded scenes save construction time and memory where no rays are traced. How much, and what do unseen rays pay?",
    write,
};

const METRICS: [Metric; 7] =
    [Metric::Steps, Metric::Tests, Metric::Time, Metric::Build, Metric::Bytes, Metric::References, Metric::Worst];

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("termination");
    let all = study.pairs("termination");
    if pairs.is_empty() {
        return None;
    }
    let findings =
        group(&pairs, &[Key::Setting, Key::Spec]).iter().filter_map(|g| finding(&g.labels, &g.pairs)).collect();
    let caption = |what: &str| html! { (what) " by rule of termination, relative to the base." };
    // The 99.9th percentile is one of rays of a class; a sum over classes has none.
    let worst: Vec<&Pair<'_>> =
        all.into_iter().filter(|p| p.class.is_some() && p.ratio(Metric::Worst).is_some()).collect();
    let body = html! {
        (forest_of(study, &pairs, [Key::Setting, Key::Spec], Metric::Bytes, &caption("Memory")))
        (forest_of(study, &pairs, [Key::Setting, Key::Spec], Metric::Build, &caption("Build time")))
        (effects("By rule of termination", &pairs, &[Key::Setting, Key::Spec, Key::Base], &METRICS))
        @if !worst.is_empty() {
            (effects("What the dearest rays pay: the 99.9th percentile of steps + tests", &worst, &[Key::Setting, Key::Class, Key::Spec], &[Metric::Worst]))
        }
    };
    Some(Section { findings, body })
}

fn finding(labels: &[String], pairs: &[&Pair<'_>]) -> Option<Markup> {
    let said = [Metric::Steps, Metric::Bytes, Metric::Build]
        .into_iter()
        .filter_map(|m| Some(words::change(&effect(pairs, m)?, m)));
    let said: Vec<String> = said.collect();
    let place = if labels[0].is_empty() { String::new() } else { format!("{}, ", labels[0]) };
    (!said.is_empty())
        .then(|| html! { (place) code { (labels[1]) } " against " code { (pairs[0].base) } ": " (words::list(&said)) })
}
