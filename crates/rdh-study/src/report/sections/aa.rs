//! A run against itself: what the clock alone makes of no difference.

use maud::html;

use super::super::effect::{Effect, Verdict};
use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects};
use super::super::view::Study;
use super::super::words;
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "aa",
    title: "A run against itself",
    question: "The same structure twice, interleaved as two structures are: does the measurement say “no difference”?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pairs = study.totals("aa");
    let time = Effect::of(pairs.iter().copied(), Metric::Time)?;
    let says = match time.verdict() {
        Verdict::Same | Verdict::Open => "No difference, as it must be",
        Verdict::Better | Verdict::Worse => "A difference that isn’t there: smaller ones than this mean nothing here",
    };
    let expected = 0.025 * time.n as f64;
    let finding = html! {
        (says) " (time " (words::figures(&time)) "); " (time.losses) " of " (words::count(time.n, "pair"))
        " look surely slower and " (time.wins) " surely faster, where chance alone makes about " (format!("{expected:.1}")) " of each"
    };
    let exact =
        pairs.iter().all(|p: &&Pair<'_>| p.ratio(Metric::Steps) == Some(1.0) && p.ratio(Metric::Tests) == Some(1.0));
    let body = html! {
        p { "Steps and tests are " @if exact { "equal in every pair, as exact counts must be." } @else { strong { "not equal: a fault of the program." } } }
        (effects("The same structure twice", &pairs, &[Key::Mode, Key::Spec], &[Metric::Steps, Metric::Tests, Metric::Time]))
    };
    Some(Section { findings: vec![finding], body })
}
