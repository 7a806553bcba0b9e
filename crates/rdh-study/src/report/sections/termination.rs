//! When to stop: the same rules for both, pruning, and leaving alone what no ray reaches.

use maud::{Markup, html};
use rdh_scene::Kind;

use super::super::group::{Key, group};
use super::super::pairs::{Metric, Pair};
use super::super::table::{effects, ratio, table};
use super::super::view::Study;
use super::super::words;
use super::common::{best_of_settings, effect, forest_of};
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
    let findings = idle(&pairs, &all).into_iter().chain(rules(&pairs)).collect();
    let caption = |what: &str| html! { (what) " by rule of termination, relative to the base." };
    // The same trees stand in several settings, for several sorts of rays.
    let trees: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| !is_idle_setting(p) || is_learnt(p)).collect();
    let body = html! {
        (forest_of(study, &trees, [Key::Setting, Key::Spec], Metric::Bytes, &caption("Memory")))
        (forest_of(study, &trees, [Key::Setting, Key::Spec], Metric::Build, &caption("Build time")))
        (effects("By rule of termination", &pairs, &[Key::Setting, Key::Spec, Key::Base], &METRICS))
        (dearest(&all))
    };
    Some(Section { findings, body })
}

/// What the dearest rays pay. A percentile belongs to rays of one class, so that classes are pairs of their own here.
fn dearest(all: &[&Pair<'_>]) -> Markup {
    let has = |p: &&Pair<'_>| p.class.is_some() && p.ratio(Metric::Worst).is_some() && is_idle_setting(p);
    let pairs: Vec<&Pair<'_>> = all.iter().copied().filter(has).collect();
    let mut rows = Vec::new();
    for setting in group(&pairs, &[Key::Setting]) {
        rows.push(vec![html! { (setting.labels[0]) }]);
        for g in group(&setting.pairs, &[Key::Spec]) {
            if let Some(e) = effect(&g.pairs, Metric::Worst) {
                rows.push(vec![
                    html! { code { (g.labels[0]) } },
                    html! { (e.n) },
                    ratio(&e),
                    html! { (words::digits(e.most)) },
                ]);
            }
        }
    }
    let heads = ["spec", ">views and classes", ">99.9th percentile", ">largest"];
    html! { @if !rows.is_empty() { (table("What the dearest rays pay: the 99.9th percentile of steps + tests", &heads, &rows)) } }
}

fn is_idle_setting(pair: &Pair<'_>) -> bool {
    pair.setting.starts_with("idle")
}

fn is_learnt(pair: &Pair<'_>) -> bool {
    pair.setting.contains("learnt")
}

/// Leaving nodes alone where rays spend little: what is saved, in dense scenes if there are any, by the spec that saves most memory
/// among those whose learnt rays need no more steps than the base's.
fn idle(pairs: &[&Pair<'_>], all: &[&Pair<'_>]) -> Vec<Markup> {
    let mut idle: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| is_idle(p) && is_learnt(p)).collect();
    let dense = idle.iter().any(|p| p.kind == Kind::Dense);
    idle.retain(|p| !dense || p.kind == Kind::Dense);
    let as_fast = |pairs: &[&Pair<'_>]| effect(pairs, Metric::Steps).is_some_and(|e| e.mean <= 1.0);
    let specs = group(&idle, &[Key::Spec]).into_iter().filter(|g| as_fast(&g.pairs));
    let Some(best) = specs.min_by(|a, b| bytes(&a.pairs).total_cmp(&bytes(&b.pairs))) else { return Vec::new() };
    let metrics = [Metric::Bytes, Metric::Build, Metric::References, Metric::Steps, Metric::Time];
    let saved = metrics.into_iter().filter_map(|m| Some(words::said(&effect(&best.pairs, m)?, m)));
    let said = html! {
        @if dense { "Dense scenes: " }
        code { (best.labels[0]) } ", which leaves nodes as they are where rays spend little: " (words::list(&saved.collect::<Vec<_>>())) " against "
        code { (best.pairs[0].base) } ", over " (words::count(best.pairs.len(), "pair"))
    };
    let of_best = |p: &&Pair<'_>| p.spec == best.pairs[0].spec && (!dense || p.kind == Kind::Dense);
    let unseen: Vec<&Pair<'_>> = all
        .iter()
        .copied()
        .filter(of_best)
        .filter(|p| p.class.is_some() && is_idle_setting(p) && !is_learnt(p))
        .collect();
    let pays = group(&unseen, &[Key::Setting]).into_iter().filter_map(|g| {
        let worst = effect(&g.pairs, Metric::Worst)?;
        let rays = g.labels[0].trim_start_matches("idle: ").to_owned();
        Some(html! {
            "Of that tree, " (rays) " pay at the 99.9th percentile of steps + tests " (words::figures(&worst)) " of the base, at most "
            (words::digits(worst.most)) @if worst.most <= 2.0 { ": never more than twice" } @else { ", more than twice" }
        })
    });
    std::iter::once(said).chain(pays).collect()
}

fn bytes(pairs: &[&Pair<'_>]) -> f64 {
    effect(pairs, Metric::Bytes).map_or(f64::INFINITY, |e| e.mean)
}

fn is_idle(pair: &Pair<'_>) -> bool {
    pair.spec.needs_rays() && pair.spec.to_string().contains("idle=")
}

/// The rules, the same for both heuristics.
fn rules(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let rules: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| !is_idle_setting(p)).collect();
    let said = best_of_settings(&rules, Metric::Steps)?;
    Some(html! { "With the same rule for both heuristics: " (said) })
}
