//! What several sections are made of.

use maud::{Markup, html};

use super::super::effect::Effect;
use super::super::figure::figure;
use super::super::pairs::{Metric, Pair};
use super::super::svg::{Entry, Line, Upwards, forest, lines};
use super::super::table::{Group, Key, group};
use super::super::view::Study;
use super::super::words;
use crate::study::Curve;

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

/// A forest plot of groups by two keys: headings, and lines below them.
pub(super) fn forest_of(
    study: &Study<'_>,
    pairs: &[&Pair<'_>],
    keys: [Key; 2],
    metric: Metric,
    caption: &Markup,
) -> Markup {
    let entries = entries(study, pairs, keys, metric);
    let says =
        format!("Forest plot: {}, means with 95 % intervals; the figures stand beside each line", axis_of(metric));
    figure(caption, &[], |width| forest(&entries, &axis_of(metric), &says, width))
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

/// Ratios over the experiment's axis, one line for each spec and what its settings have in common.
pub(super) fn lines_over_x(
    study: &Study<'_>,
    pairs: &[&Pair<'_>],
    metric: Metric,
    across: &str,
    caption: &Markup,
) -> Markup {
    let drawn = series_over_x(study, pairs, metric);
    let legend: Vec<(usize, String)> = drawn.iter().map(|l| (l.series, l.name.clone())).collect();
    let upwards = format!("{}, ratio to the base: below 1 is better", metric.name());
    let says = format!("Line plot: {upwards}, over {across}, with 95 % intervals as bands");
    figure(caption, &legend, |width| lines(&drawn, Upwards::Ratios, [across, &upwards], &says, width))
}

/// One line for each spec and family of settings, over x.
pub(super) fn series_over_x(study: &Study<'_>, pairs: &[&Pair<'_>], metric: Metric) -> Vec<Line> {
    let mut named: Vec<(String, Vec<&Pair<'_>>)> = Vec::new();
    for &pair in pairs.iter().filter(|p| p.x.is_some()) {
        let name = series_name(pair);
        match named.iter_mut().find(|n| n.0 == name) {
            Some(found) => found.1.push(pair),
            None => named.push((name, vec![pair])),
        }
    }
    let specs: Vec<_> = named.iter().map(|n| n.1[0].spec).collect();
    let distinct = specs.iter().enumerate().all(|(i, s)| !specs[..i].contains(s));
    let line = |(i, (name, pairs)): (usize, (String, Vec<&Pair<'_>>))| Line {
        series: if distinct { study.series(&pairs[0].spec) } else { i },
        name,
        points: points(&pairs, metric),
    };
    named.into_iter().enumerate().map(line).collect()
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

/// The setting without its number, and the spec.
fn series_name(pair: &Pair<'_>) -> String {
    let is_word = |c: char| c.is_alphabetic() || c == ' ' || c == '-';
    let words: String = pair.setting.chars().filter(|c| is_word(*c)).collect();
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    if words.is_empty() { pair.spec.to_string() } else { format!("{}, {words}", pair.spec) }
}

/// Curves of some records with one quantity across: their names, and the weighted means at each x.
pub(super) fn mean_curves<'c>(curves: impl Iterator<Item = &'c Curve>) -> Vec<(String, Vec<[f64; 2]>)> {
    let mut named: Vec<(String, Vec<[f64; 3]>)> = Vec::new();
    for curve in curves {
        let points = curve.points.iter().filter(|p| p.iter().all(|v| v.is_finite()) && p[2] > 0.0);
        match named.iter_mut().find(|n| n.0 == curve.name) {
            Some(found) => found.1.extend(points),
            None => named.push((curve.name.clone(), points.copied().collect())),
        }
    }
    named.into_iter().map(|(name, points)| (name, weighted_means(points))).collect()
}

fn weighted_means(mut points: Vec<[f64; 3]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mean = |same: &[[f64; 3]]| {
        let weight: f64 = same.iter().map(|p| p[2]).sum();
        [same[0][0], same.iter().map(|p| p[1] * p[2]).sum::<f64>() / weight]
    };
    points.chunk_by(|a, b| a[0] == b[0]).map(mean).collect()
}

/// All curves as figures: those over one quantity, whose names begin alike (up to the first comma), share a plot.
pub(super) fn curve_plots(curves: &[&Curve]) -> Markup {
    let mut plots: Vec<((&str, &str), Vec<&Curve>)> = Vec::new();
    for &curve in curves.iter().filter(|c| c.points.len() > 1) {
        let key = (curve.across.as_str(), stem(&curve.name));
        match plots.iter_mut().find(|p| p.0 == key) {
            Some(found) => found.1.push(curve),
            None => plots.push((key, vec![curve])),
        }
    }
    html! { @for ((across, name), curves) in &plots { (curve_plot(curves, across, name)) } }
}

fn stem(name: &str) -> &str {
    name.split_once(',').map_or(name, |parts| parts.0).trim()
}

fn curve_plot(curves: &[&Curve], across: &str, name: &str) -> Markup {
    let drawn: Vec<Line> = mean_curves(curves.iter().copied()).into_iter().enumerate().map(plain_line).collect();
    let legend: Vec<(usize, String)> = drawn.iter().map(|l| (l.series, l.name.clone())).collect();
    let says = format!("Line plot: {name} over {across}");
    let caption = html! { (name) " over " (across) "; weighted means over all views." };
    figure(&caption, &legend, |width| lines(&drawn, Upwards::Values, [across, name], &says, width))
}

fn plain_line((series, (name, points)): (usize, (String, Vec<[f64; 2]>))) -> Line {
    let short = name.split_once(',').map_or(name.as_str(), |parts| parts.1.trim());
    Line { series, name: short.to_owned(), points: points.iter().map(|p| [p[0], p[1], p[1], p[1]]).collect() }
}
