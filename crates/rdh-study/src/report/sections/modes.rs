//! The main table: by mode and class.

use maud::{Markup, html};

use super::super::pairs::{Metric, Pair};
use super::super::table::{Key, effects};
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
    let findings = [primary(&study.ours()), others(&study.ours())].into_iter().flatten().collect();
    let caption = |what: &str| html! { "The " (what) " of each structure relative to the base, by the rays that were cast; all classes of a mode together." };
    let body = html! {
        (forest_of(study, &totals, [Key::Mode, Key::Spec], Metric::Time, &caption("time")))
        (forest_of(study, &totals, [Key::Mode, Key::Spec], Metric::Steps, &caption("steps")))
        (effects("By mode and class", &parts, &[Key::Mode, Key::Class, Key::Spec, Key::Base], &COSTS))
    };
    Some(Section { findings, body })
}

fn primary(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let here = of_mode(pairs, Mode::Primary);
    let time = effect(&here, Metric::Time)?;
    Some(html! {
        "Primary rays, " code { (ours()) } " against " code { (here[0].base) } ": " (costs_said(&here)) ", in " (words::count(time.n, "view")) " of "
        (words::count(time.scenes, "scene")) "; surely faster in " (time.wins) " of them, surely slower in " (time.losses)
    })
}

/// The other modes, by their times alone: the tables have the rest.
fn others(pairs: &[&Pair<'_>]) -> Option<Markup> {
    let said = |mode: Mode| {
        let time = effect(&of_mode(pairs, mode), Metric::Time)?;
        Some(format!("{}: {}", words::rays_of(mode), words::said(&time, Metric::Time)))
    };
    let said: Vec<String> = Mode::ALL.into_iter().filter(|m| *m != Mode::Primary).filter_map(said).collect();
    (!said.is_empty()).then(|| html! { (said.join("; ")) })
}

fn of_mode<'p, 'r>(pairs: &[&'p Pair<'r>], mode: Mode) -> Vec<&'p Pair<'r>> {
    pairs.iter().copied().filter(|p| p.job.mode == mode).collect()
}
