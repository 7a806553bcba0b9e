//! Time to image, frame by frame.

use maud::{Markup, html};

use super::super::group::{Group, Key, group};
use super::super::pairs::{Metric, Pair};
use super::super::table::effects;
use super::super::view::Study;
use super::super::words;
use super::common::{effect, families, lines_over_x};
use super::{Chapter, Section};
use crate::study::experiment::frames::BESIDE_QUICK;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "frames",
    title: "Time to image",
    question: "If the scene is new in every frame, what counts is all of it: rays known, structure built, rays cast once. Who wins?",
    write,
};

const METRICS: [Metric; 3] = [Metric::Frame, Metric::Build, Metric::Time];

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("frames");
    if pairs.is_empty() {
        return None;
    }
    let (quick, all): (Vec<&Pair<'_>>, Vec<&Pair<'_>>) =
        pairs.into_iter().partition(|p| p.setting.contains(BESIDE_QUICK));
    let findings = families(&quick).iter().filter_map(|(way, pairs)| fastest(way, pairs)).collect();
    let caption = html! { "The whole frame over the way, relative to the base." };
    let body = html! {
        p {
            "Each frame begins with nothing but the mesh. A picture of 640 × 480 pixels casts a primary ray a pixel and a shadow ray to one light "
            "from each hit that faces it; a scanner’s turn has 64 × 2,048 rays. “whole frame” is what recording the frame’s rays for the next one took "
            "(where a structure is built for rays), the build, and casting all rays once, together, on one thread: what grows meanwhile is in it. "
            code { "kd+sah" } " has at most 16 levels here: the shallow tree. " code { "kd(eye)+rdh" } " are trees around the frame’s own eye. " code { "auto" } " is the one of three (lazy, quick, lazy for the rays "
            "of the frame before) that would have taken least by the frames before; each is tried on one frame first."
        }
        (lines_over_x(study, &all, Metric::Frame, "frame", &caption))
        (tables("beside the exact kd-tree", &all))
        (tables("beside the quick hierarchy", &quick))
    };
    Some(Section { findings, body })
}

/// A table a way, to be opened.
fn tables(beside: &str, pairs: &[&Pair<'_>]) -> Markup {
    html! {
        details {
            summary { "Time to image, way by way, " (beside) }
            @for (way, pairs) in &families(pairs) {
                (effects(&format!("Time to image: {way}"), pairs, &[Key::Spec, Key::Base], &METRICS))
            }
        }
    }
}

/// Which structure took least for a whole frame, or came nearest to the base.
fn fastest(way: &str, pairs: &[&Pair<'_>]) -> Option<Markup> {
    let of = |g: Group<'_, '_>| Some((effect(&g.pairs, Metric::Frame)?, g.labels[0].clone()));
    let least = group(pairs, &[Key::Spec]).into_iter().filter_map(of);
    let (effect, spec) = least.min_by(|a, b| a.0.mean.total_cmp(&b.0.mean))?;
    let base = pairs.first()?.base;
    let way = way.replace(&format!(", {BESIDE_QUICK}"), "");
    let said = words::said(&effect, Metric::Frame);
    Some(if effect.mean < 1.0 {
        html! { (way) ": " code { (spec) } " takes least, beside " code { (base) } ": " (said) }
    } else {
        html! { (way) ": " code { (base) } " takes least; next is " code { (spec) } ": " (said) }
    })
}
