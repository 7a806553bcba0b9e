//! What knowing the rays costs: build time, memory, and when it has paid.

use maud::{Markup, html};

use super::super::figure::figure;
use super::super::group::{Key, group};
use super::super::pairs::{Metric, Pair};
use super::super::svg::{Dot, scatter};
use super::super::table::effects;
use super::super::view::{Study, ours};
use super::super::words;
use super::common::{effect, forest_of};
use super::{Chapter, Section};
use crate::stats::median;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "costs",
    title: "What it costs: build and memory",
    question: "How long does the build take and how large is the tree, and after how many rays has it paid?",
    write,
};

const METRICS: [Metric; 4] = [Metric::Build, Metric::BuildAndRays, Metric::Bytes, Metric::References];

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs: Vec<&Pair<'_>> = study.main().into_iter().filter(|p| p.class.is_none()).collect();
    if pairs.is_empty() {
        return None;
    }
    let caption = html! { "Memory of the trees and their copies of triangles, relative to the base." };
    let body = html! {
        (build_against_trace(study, &pairs))
        (forest_of(study, &pairs, [Key::Mode, Key::Spec], Metric::Bytes, &caption))
        (effects("Build and memory", &pairs, &[Key::Mode, Key::Spec, Key::Base], &METRICS))
        (effects("Build and memory by kind of scene", &study.ours(), &[Key::Kind, Key::Spec], &METRICS))
    };
    Some(Section { findings: finding(&study.ours()).into_iter().collect(), body })
}

fn finding(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let (build, bytes) = (effect(pairs, Metric::BuildAndRays)?, effect(pairs, Metric::Bytes)?);
    let needed: Vec<f64> = pairs.iter().filter_map(|p| rays_until_paid(p)).collect();
    Some(html! {
        code { (ours()) } " against " code { (pairs[0].base) } ": " (words::said(&build, Metric::BuildAndRays)) " and " (words::said(&bytes, Metric::Bytes))
        @if needed.is_empty() { "; it has paid in none of the pairs" } @else {
            "; it has paid after " (words::grouped(median(&needed))) " rays at the median of the " (words::count(needed.len(), "pair"))
            " that it speeds up (of " (pairs.len()) ")"
        }
    })
}

/// After how many rays the dearer build is earned back; nothing if rays are no faster.
fn rays_until_paid(pair: &Pair<'_>) -> Option<f64> {
    let (ours, theirs) = (&pair.ours, &pair.theirs);
    let saved_secs_a_ray = (theirs.nanos - ours.nanos) / ours.rays * 1e-9;
    let extra_secs = ours.build_secs + ours.rrs_secs - theirs.build_secs;
    (saved_secs_a_ray > 0.0).then(|| (extra_secs / saved_secs_a_ray).max(0.0))
}

fn build_against_trace(study: &Study<'_>, pairs: &[&Pair<'_>]) -> Markup {
    let dot = |p: &&Pair<'_>| {
        let (x, y) = (p.ratio(Metric::BuildAndRays)?, p.ratio(Metric::Time)?);
        Some(Dot {
            x,
            y,
            series: study.series(&p.spec),
            says: format!("{} {}: {y:.3} at {x:.1}", p.place(), p.job.mode),
        })
    };
    let dots: Vec<Dot> = pairs.iter().filter_map(dot).collect();
    let legend: Vec<(usize, String)> =
        group(pairs, &[Key::Spec]).iter().map(|g| (study.series(&g.pairs[0].spec), g.labels[0].clone())).collect();
    let labels = ["build + training rays, ratio to the base", "time a ray, ratio to the base"];
    let says = "Scatter plot of tracing time over build time, both relative to the base, one mark a view and mode";
    let caption = html! { "Build against trace: to the right dearer to build, downwards faster to trace. One mark a view and mode." };
    figure(&caption, &legend, |width| scatter(&dots, labels, says, width))
}
