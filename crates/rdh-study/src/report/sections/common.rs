//! What several sections are made of.

use maud::{Markup, html};

use super::super::effect::Effect;
use super::super::figure::figure;
use super::super::pairs::{Metric, Pair};
use super::super::svg::{Entry, Line, Upwards, forest, lines};
use super::super::table::{Group, Key, family, group};
use super::super::view::Study;
use super::super::words;

/// What is compared wherever rays are cast.
pub(super) const COSTS: [Metric; 3] = [Metric::Steps, Metric::Tests, Metric::Time];

/// What stands below an axis of ratios.
pub(super) fn axis_of(metric: Metric) -> String {
    format!("{}, ratio to the base: left of 1 is better", metric.name())
}

/// The effect over some pairs.
pub(super) fn effect(pairs: &[&Pair<'_>], metric: Metric) -> Option<Effect> {
    Effect::of(pairs.iter().copied(), metric)
}

/// Steps, tests and time as one sentence.
pub(super) fn costs_said(pairs: &[&Pair<'_>]) -> String {
    let said = COSTS.into_iter().filter_map(|m| Some(words::said(&effect(pairs, m)?, m)));
    words::list(&said.collect::<Vec<_>>())
}

/// The best spec of every setting in words; of many settings the best and the worst.
pub(super) fn best_of_settings(pairs: &[&Pair<'_>], metric: Metric) -> Option<Markup> {
    let best = |g: Group<'_, '_>| {
        let of = |g: Group<'_, '_>| Some((effect(&g.pairs, metric)?, g.labels[0].clone()));
        let (effect, spec) = group(&g.pairs, &[Key::Spec]).into_iter().filter_map(of).min_by(by_mean)?;
        Some((effect, g.labels[0].clone(), spec))
    };
    let mut bests: Vec<(Effect, String, String)> = group(pairs, &[Key::Setting]).into_iter().filter_map(best).collect();
    if bests.len() > 4 {
        bests.sort_by(|a, b| a.0.mean.total_cmp(&b.0.mean));
        bests.drain(1..bests.len() - 1);
    }
    let said = |(effect, setting, spec): &(Effect, String, String)| {
        html! { @if !setting.is_empty() { "“" (setting) "” " } code { (spec) } ": " (words::said(effect, metric)) }
    };
    let said: Vec<Markup> = bests.iter().map(said).collect();
    (!said.is_empty()).then(|| html! { @for (i, part) in said.iter().enumerate() { @if i > 0 { "; " } (part) } })
}

fn by_mean(a: &(Effect, String), b: &(Effect, String)) -> std::cmp::Ordering {
    a.0.mean.total_cmp(&b.0.mean)
}

/// A forest plot of groups by two keys: headings, and lines below them.
pub(super) fn forest_of(
    study: &Study<'_>,
    pairs: &[&Pair<'_>],
    keys: [Key; 2],
    metric: Metric,
    caption: &Markup,
) -> Markup {
    forest_figure(&entries(study, pairs, keys, metric), &axis_of(metric), caption)
}

/// A forest plot of entries that are there already.
pub(super) fn forest_figure(entries: &[Entry], axis: &str, caption: &Markup) -> Markup {
    let says = format!("Forest plot: {axis}, means with 95\u{a0}% intervals; the figures stand beside each line");
    figure(caption, &[], |width| forest(entries, axis, &says, width))
}

fn entries(study: &Study<'_>, pairs: &[&Pair<'_>], [outer, inner]: [Key; 2], metric: Metric) -> Vec<Entry> {
    let mut entries = Vec::new();
    let outer_groups = group(pairs, &[outer]);
    for Group { labels, pairs } in &outer_groups {
        if outer_groups.len() > 1 && !labels[0].is_empty() {
            entries.push(Entry::Head(labels[0].clone()));
        }
        for inside in group(pairs, &[inner]) {
            let series = study.series(&inside.pairs[0].spec);
            if let Some(effect) = effect(&inside.pairs, metric) {
                entries.push(Entry::Mean { label: inside.labels[0].clone(), series, effect });
            }
        }
    }
    entries
}

/// Ratios over the experiment's axis: a plot for each family of settings (those that differ in their number alone), in it a
/// line for each spec, or one for all specs where each has but one point.
pub(super) fn lines_over_x(
    study: &Study<'_>,
    pairs: &[&Pair<'_>],
    metric: Metric,
    across: &str,
    caption: &Markup,
) -> Markup {
    let families = families(pairs);
    html! {
        @for (family, pairs) in &families {
            @let across = if families.len() > 1 { family.as_str() } else { across };
            (line_figure(&lines_of(study, family, pairs, metric), metric, across, caption))
        }
    }
}

fn line_figure(drawn: &[Line], metric: Metric, across: &str, caption: &Markup) -> Markup {
    let legend: Vec<(usize, String)> = drawn.iter().map(|l| (l.series, l.name.clone())).collect();
    let upwards = format!("{}, ratio to the base: below 1 is better", metric.name());
    let says = format!("Line plot: {upwards}, over {across}, with 95\u{a0}% intervals as bands");
    figure(caption, &legend, |width| lines(drawn, Upwards::Ratios, [across, &upwards], &says, width))
}

/// Pairs that have a place on the axis, by what their settings have in common.
pub(super) fn families<'p, 'r>(pairs: &[&'p Pair<'r>]) -> Vec<(String, Vec<&'p Pair<'r>>)> {
    let mut families: Vec<(String, Vec<&Pair<'_>>)> = Vec::new();
    for &pair in pairs.iter().filter(|p| p.x.is_some()) {
        let name = family(pair);
        match families.iter_mut().find(|f| f.0 == name) {
            Some(found) => found.1.push(pair),
            None => families.push((name, vec![pair])),
        }
    }
    families
}

/// The lines of one family.
pub(super) fn lines_of(study: &Study<'_>, family: &str, pairs: &[&Pair<'_>], metric: Metric) -> Vec<Line> {
    let by_spec = group(pairs, &[Key::Spec]);
    let of_spec = |g: &Group<'_, '_>| Line {
        series: study.series(&g.pairs[0].spec),
        name: g.labels[0].clone(),
        points: points(&g.pairs, metric),
    };
    let drawn: Vec<Line> = by_spec.iter().map(of_spec).collect();
    if drawn.iter().all(|l| l.points.len() < 2) {
        return vec![Line { series: 0, name: family.to_owned(), points: points(pairs, metric) }];
    }
    drawn
}

/// The effect at every x: `[x, mean, low, high]`.
pub(super) fn points(pairs: &[&Pair<'_>], metric: Metric) -> Vec<[f64; 4]> {
    let mut xs: Vec<f64> = pairs.iter().filter_map(|p| p.x).collect();
    xs.sort_unstable_by(f64::total_cmp);
    xs.dedup();
    let at = |x: f64| {
        let here: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.x == Some(x)).collect();
        effect(&here, metric).map(|e| [x, e.mean, e.interval[0], e.interval[1]])
    };
    xs.into_iter().filter_map(at).collect()
}
