//! Curves as figures: what is no pair, such as chances by depth of the tree.

use maud::{Markup, html};
use rdh::Spec;

use super::super::effect::Effect;
use super::super::figure::figure;
use super::super::svg::{Entry, Line, Upwards, lines};
use super::super::view::Study;
use super::super::words;
use super::common::forest_figure;
use crate::rows::Curve;

/// All curves as figures. Their names have parts: what is measured, which line it is, and perhaps a group at the end; what is
/// measured over one quantity, in one group, shares a plot. Curves of single points become forest plots of their means.
pub(super) fn curve_plots(study: &Study<'_>, curves: &[&Curve]) -> Markup {
    let mut plots: Vec<(Plot<'_>, Vec<&Curve>)> = Vec::new();
    let mut single: Vec<(&str, Vec<&Curve>)> = Vec::new();
    for &curve in curves.iter().filter(|c| !c.points.is_empty()) {
        let name = Name::of(curve);
        if curve.points.len() == 1 {
            add(&mut single, name.stem, curve);
        } else {
            add(&mut plots, (curve.across.as_str(), name.stem, name.group), curve);
        }
    }
    html! {
        @for ((across, stem, group), curves) in &plots { (curve_plot(study, curves, (across, stem, group))) }
        @for (stem, curves) in &single { (point_forest(curves, stem)) }
    }
}

/// What is across, what is measured, and in which group.
type Plot<'c> = (&'c str, &'c str, &'c str);

fn add<'c, K: PartialEq>(groups: &mut Vec<(K, Vec<&'c Curve>)>, key: K, curve: &'c Curve) {
    match groups.iter_mut().find(|g| g.0 == key) {
        Some(found) => found.1.push(curve),
        None => groups.push((key, vec![curve])),
    }
}

/// The parts of a curve's name.
#[derive(Debug, PartialEq, Eq)]
struct Name<'c> {
    stem: &'c str,
    line: &'c str,
    group: &'c str,
}

impl<'c> Name<'c> {
    fn of(curve: &'c Curve) -> Self {
        Self::parse(&curve.name)
    }

    fn parse(name: &'c str) -> Self {
        let (stem, rest) = name.split_once(", ").unwrap_or((name, ""));
        let (line, group) = rest.rsplit_once(", ").unwrap_or((rest, ""));
        Self { stem, line, group }
    }
}

fn curve_plot(study: &Study<'_>, curves: &[&Curve], (across, stem, group): Plot<'_>) -> Markup {
    let drawn = mean_curves(study, curves);
    let legend: Vec<(usize, String)> = drawn.iter().map(|l| (l.series, l.name.clone())).collect();
    let upwards_are = if stem.contains(" / ") { Upwards::Ratios } else { Upwards::Values };
    let of_group = if group.is_empty() { String::new() } else { format!(", {group}") };
    let says = format!("Line plot: {stem} over {across}{of_group}");
    let caption = html! { (words::capital(stem)) (of_group) ", over " (across) "; weighted means over all views, as far as more than a few rays go." };
    figure(&caption, &legend, |width| lines(&drawn, upwards_are, [across, stem], &says, width))
}

/// Single points are one figure a view: their geometric means over scenes.
fn point_forest(curves: &[&Curve], stem: &str) -> Markup {
    let mut entries = Vec::new();
    let mut groups: Vec<(&str, Vec<&Curve>)> = Vec::new();
    for &curve in curves {
        add(&mut groups, Name::of(curve).group, curve);
    }
    for (group, curves) in &groups {
        if !group.is_empty() {
            entries.push(Entry::Head((*group).to_owned()));
        }
        let mut lines: Vec<(&str, Vec<&Curve>)> = Vec::new();
        for &curve in curves {
            add(&mut lines, Name::of(curve).line, curve);
        }
        for (series, (label, curves)) in lines.iter().enumerate() {
            let ratios = curves.iter().map(|c| (c.scene.as_str(), c.points[0][1]));
            entries.extend(Effect::of_ratios(ratios).map(|effect| Entry::Mean {
                label: (*label).to_owned(),
                series,
                effect,
            }));
        }
    }
    let caption = html! { (words::capital(stem)) "; means over scenes with 95\u{a0}% intervals." };
    forest_figure(&entries, stem, &caption)
}

/// Curves of one name and spec as one: the weighted means at each x.
fn mean_curves(study: &Study<'_>, curves: &[&Curve]) -> Vec<Line> {
    let mut named: Vec<(&str, Spec, Vec<[f64; 3]>)> = Vec::new();
    for curve in curves {
        let points = curve.points.iter().filter(|p| p.iter().all(|v| v.is_finite()) && p[2] > 0.0);
        match named.iter_mut().find(|n| n.0 == curve.name && n.1 == curve.spec) {
            Some(found) => found.2.extend(points),
            None => named.push((&curve.name, curve.spec, points.copied().collect())),
        }
    }
    let one_spec = named.iter().all(|n| n.1 == named[0].1);
    let one_name = named.iter().all(|n| n.0 == named[0].0);
    let line = |(i, (name, spec, points)): (usize, &(&str, Spec, Vec<[f64; 3]>))| {
        // A spec has the same colour everywhere.
        let (series, name) = match (one_name, one_spec) {
            (true, _) => (study.series(spec), spec.to_string()),
            (_, true) => (i, Name::parse(name).line.to_owned()),
            _ => (i, format!("{}, {spec}", Name::parse(name).line)),
        };
        let points = weighted_means(points.clone()).into_iter().map(|[x, y]| [x, y, y, y]).collect();
        Line { series, name, points }
    };
    named.iter().enumerate().map(line).collect()
}

/// Points of which less than this share of the heaviest one's weight is known are noise.
const LEAST_WEIGHT: f64 = 0.002;

/// The weighted mean at each x; nothing where hardly anything weighs.
fn weighted_means(mut points: Vec<[f64; 3]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let weight = |same: &[[f64; 3]]| same.iter().map(|p| p[2]).sum::<f64>();
    let mean = |same: &[[f64; 3]]| [same[0][0], same.iter().map(|p| p[1] * p[2]).sum::<f64>() / weight(same)];
    let at_each = || points.chunk_by(|a, b| a[0] == b[0]);
    let heaviest = at_each().map(weight).fold(0.0, f64::max);
    at_each().filter(|same| weight(same) >= LEAST_WEIGHT * heaviest).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_parts() {
        let name = Name::parse("p estimated / p measured, by areas, tree of sah");
        assert_eq!(name, Name { stem: "p estimated / p measured", line: "by areas", group: "tree of sah" });
        assert_eq!(Name::parse("bytes"), Name { stem: "bytes", line: "", group: "" });
    }

    #[test]
    fn weights_count_and_equal_places_join() {
        let means = weighted_means(vec![[2.0, 5.0, 1.0], [1.0, 1.0, 1.0], [9.0, 7.0, 0.001], [1.0, 4.0, 2.0]]);
        assert_eq!(means, [[1.0, 3.0], [2.0, 5.0]]);
    }
}
