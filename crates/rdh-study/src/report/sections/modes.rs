//! The main table: by mode and class.

use maud::html;

use super::super::effect::Effect;
use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects, legend};
use super::super::view::{Study, ours};
use super::super::words;
use super::common::{COSTS, costs_said, effect, forest_of};
use super::{Chapter, Section};
use crate::integrate::Mode;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "rays",
    title: "By kind of ray",
    question: "What does a tree gain that knows the rays, over the best tree that doesn’t?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let main = study.main();
    if main.is_empty() {
        return None;
    }
    let totals: Vec<&Pair<'_>> = main.iter().copied().filter(|p| p.class.is_none()).collect();
    // A mode of one class is its own total.
    let parts: Vec<&Pair<'_>> =
        main.iter().copied().filter(|p| p.class.is_none() || p.job.mode.classes().len() > 1).collect();
    let findings = Mode::ALL.into_iter().filter_map(|mode| finding(&study.ours(), mode)).collect();
    let caption = |what: &str| html! { "The " (what) " of each structure relative to the base, by the rays that were cast; all classes of a mode together." };
    let body = html! {
        (forest_of(study, &totals, [Key::Mode, Key::Spec], Metric::Time, &caption("time")))
        (forest_of(study, &totals, [Key::Mode, Key::Spec], Metric::Steps, &caption("steps")))
        (effects("By mode and class", &parts, &[Key::Mode, Key::Class, Key::Spec, Key::Base], &COSTS))
        (legend())
    };
    Some(Section { findings, body })
}

fn finding(pairs: &[&Pair<'_>], mode: Mode) -> Option<maud::Markup> {
    let here: Vec<&Pair<'_>> = pairs.iter().copied().filter(|p| p.job.mode == mode).collect();
    let time: Effect = effect(&here, Metric::Time)?;
    Some(html! {
        (words::rays_of(mode)) ", " code { (ours()) } " against " code { (here[0].base) } ": " (costs_said(&here)) ", in "
        (words::count(time.n, "view")) " of " (words::count(time.scenes, "scene"))
        "; it is surely faster in " (time.wins) " of them and surely slower in " (time.losses)
    })
}
