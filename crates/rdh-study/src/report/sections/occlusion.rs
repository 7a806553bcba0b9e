//! Gain against measured depth complexity.

use maud::{Markup, html};

use super::super::figure::figure;
use super::super::pairs::{Metric, Pair};
use super::super::svg::{Dot, scatter};
use super::super::view::{Study, ours};
use super::super::words;
use super::common::axis_of;
use super::{Chapter, Section};
use rdh_scene::Kind;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "occlusion",
    title: "Gain against occlusion",
    question: "Areas assume that nothing is hidden. Is more gained where more is hidden?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs: Vec<&Pair<'_>> =
        study.totals("occlusion").into_iter().filter(|p| p.depth_complexity.is_some()).collect();
    let pairs = preferring_ours(pairs);
    if pairs.is_empty() {
        return None;
    }
    let findings = [Metric::Steps, Metric::Time].into_iter().filter_map(|m| finding(&pairs, m)).collect();
    let body = html! {
        p {
            "Depth complexity is measured: the mean number of surfaces along a primary ray if nothing stopped it. At 1 nothing is hidden."
        }
        (plot(&pairs, Metric::Steps))
        (plot(&pairs, Metric::Time))
    };
    Some(Section { findings, body })
}

/// Ours if it was measured, else whatever was.
fn preferring_ours<'p, 'r>(pairs: Vec<&'p Pair<'r>>) -> Vec<&'p Pair<'r>> {
    let best: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.spec == ours()).collect();
    if best.is_empty() { pairs } else { best }
}

fn finding(pairs: &[&Pair<'_>], metric: Metric) -> Option<Markup> {
    let points: Vec<[f64; 2]> = pairs.iter().filter_map(|p| Some([p.depth_complexity?, p.ratio(metric)?])).collect();
    let correlation = rank_correlation(&points)?;
    let says = match correlation {
        c if c < -0.5 => "the more is hidden the larger is the gain",
        c if c < -0.25 => "where more is hidden the gain tends to be larger",
        c if c <= 0.25 => "the gain hardly depends on how much is hidden",
        _ => "where more is hidden the gain tends to be smaller",
    };
    Some(html! {
        "In " (metric.name()) ", " (says) ": the rank correlation of depth complexity and ratio is " (format!("{correlation:.2}").replace('-', "−"))
        " over " (words::count(points.len(), "view"))
    })
}

fn plot(pairs: &[&Pair<'_>], metric: Metric) -> Markup {
    let dot = |p: &&Pair<'_>| {
        let (x, y) = (p.depth_complexity?, p.ratio(metric)?);
        Some(Dot { x, y, series: p.kind as usize, says: format!("{}: {y:.3} at {x:.1}", p.place()) })
    };
    let dots: Vec<Dot> = pairs.iter().filter_map(dot).collect();
    let legend = [Kind::Open, Kind::Interior, Kind::Dense].map(|k| (k as usize, words::kind(k).to_owned()));
    let labels = ["depth complexity: surfaces along a primary ray", &format!("{}, ratio to the base", metric.name())];
    let says = format!("Scatter plot: {}, over depth complexity, one mark a view", axis_of(metric));
    let caption = html! { (metric.name()) " of " code { (pairs[0].spec) } " relative to " code { (pairs[0].base) } " over depth complexity; one mark a view." };
    figure(&caption, &legend, |width| scatter(&dots, labels, &says, width))
}

/// Spearman's rank correlation; nothing for fewer than three points, or if all are equal.
fn rank_correlation(points: &[[f64; 2]]) -> Option<f64> {
    if points.len() < 3 {
        return None;
    }
    let [x, y] = [0, 1].map(|i| ranks(&points.iter().map(|p| p[i]).collect::<Vec<_>>()));
    let mean = (points.len() as f64 - 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    let correlation = product(&x, &y) / (product(&x, &x) * product(&y, &y)).sqrt();
    correlation.is_finite().then_some(correlation)
}

/// Places in order of size; equal values share the mean of their places.
fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |v: &f64| {
        let below = values.iter().filter(|w| *w < v).count() as f64;
        let equal = values.iter().filter(|w| *w == v).count() as f64;
        below + (equal - 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rank_correlations_by_hand() {
        assert_eq!(rank_correlation(&[[1.0, 9.0], [2.0, 5.0], [30.0, 1.0]]), Some(-1.0));
        assert_eq!(rank_correlation(&[[1.0, 1.0], [2.0, 3.0], [3.0, 2.0], [4.0, 4.0]]), Some(0.8));
        assert_eq!(ranks(&[5.0, 1.0, 5.0]), [1.5, 0.0, 1.5]);
        assert_eq!(rank_correlation(&[[1.0, 2.0], [1.0, 3.0], [1.0, 4.0]]), None);
        assert_eq!(rank_correlation(&[[1.0, 2.0], [2.0, 3.0]]), None);
    }
}
