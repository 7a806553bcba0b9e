//! Tables of effects, and tables in general: each scrolls within its own box where there is no room.

use maud::{Markup, html};
use rdh::RayClass;

use super::effect::{Effect, Verdict};
use super::pairs::{Metric, Pair};
use super::words::{self, digits};
use crate::integrate::Mode;

/// A table: heads beginning with `>` stand over numbers.
pub(super) fn table(caption: &str, heads: &[&str], rows: &[Vec<Markup>]) -> Markup {
    let right = |i: usize| heads.get(i).is_some_and(|h: &&str| h.starts_with('>')).then_some("n");
    html! {
        p.caption aria-hidden="true" { (caption) }
        div.table tabindex="0" role="region" aria-label=(caption) {
            table aria-label=(caption) {
                thead { tr { @for (i, head) in heads.iter().enumerate() {
                    th scope="col" class=[right(i)] { (head.trim_start_matches('>')) }
                } } }
                tbody { @for row in rows { tr { @for (i, cell) in row.iter().enumerate() {
                    td class=[right(i)] { (cell) }
                } } } }
            }
        }
    }
}

/// Pairs that belong together in one line of a table or plot.
#[derive(Debug, Clone)]
pub(super) struct Group<'p, 'r> {
    /// What they have in common, in the order of the keys.
    pub labels: Vec<String>,
    pub pairs: Vec<&'p Pair<'r>>,
}

/// What pairs are grouped by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Key {
    Mode,
    Class,
    Kind,
    Setting,
    Spec,
    Base,
}

/// Groups pairs: by mode and class in their order, then by the axis, then in order of appearance.
pub(super) fn group<'p, 'r>(pairs: &[&'p Pair<'r>], keys: &[Key]) -> Vec<Group<'p, 'r>> {
    let mut groups: Vec<Group<'p, 'r>> = Vec::new();
    for &pair in pairs {
        let labels: Vec<String> = keys.iter().map(|k| k.label(pair)).collect();
        match groups.iter_mut().find(|g| g.labels == labels) {
            Some(group) => group.pairs.push(pair),
            None => groups.push(Group { labels, pairs: vec![pair] }),
        }
    }
    groups.sort_by(|a, b| rank(a, keys).partial_cmp(&rank(b, keys)).unwrap_or(std::cmp::Ordering::Equal));
    groups
}

/// A table of effects, one line a group. Columns in which all groups agree are left out, and so is what stands in the line above.
pub(super) fn effects(caption: &str, pairs: &[&Pair<'_>], keys: &[Key], metrics: &[Metric]) -> Markup {
    let groups = group(pairs, keys);
    let varied = |i: &usize| *i == 0 || groups.iter().any(|g| g.labels[*i] != groups[0].labels[*i]);
    let columns: Vec<usize> = (0..keys.len()).filter(varied).collect();
    let mut heads: Vec<String> = columns.iter().map(|&i| keys[i].name().to_owned()).collect();
    heads.push(">pairs".to_owned());
    heads.extend(metrics.iter().map(|m| format!(">{}", m.name())));
    if metrics.contains(&Metric::Time) {
        heads.push(">slower".to_owned());
    }
    let row = |(i, g): (usize, &Group<'_, '_>)| {
        let above = i.checked_sub(1).map(|i| &groups[i]);
        label_cells(g, above, keys, &columns).into_iter().chain(effect_cells(g, metrics)).collect()
    };
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    table(caption, &heads, &groups.iter().enumerate().map(row).collect::<Vec<_>>())
}

fn label_cells(g: &Group<'_, '_>, above: Option<&Group<'_, '_>>, keys: &[Key], columns: &[usize]) -> Vec<Markup> {
    let mut again = true;
    let cell = |&i: &usize| {
        again &= above.is_some_and(|a| a.labels[i] == g.labels[i]);
        let cell = keys[i].cell(&g.labels[i]);
        if again {
            html! { span.aside { (cell) } }
        } else {
            cell
        }
    };
    columns.iter().map(cell).collect()
}

fn effect_cells(g: &Group<'_, '_>, metrics: &[Metric]) -> Vec<Markup> {
    let effect = |m: Metric| Effect::of(g.pairs.iter().copied(), m);
    let none = || html! { "–" };
    let mut cells = vec![html! { (g.pairs.len()) }];
    cells.extend(metrics.iter().map(|&m| effect(m).map_or_else(none, |e| ratio(&e))));
    if metrics.contains(&Metric::Time) {
        cells.push(effect(Metric::Time).map_or_else(none, |e| html! { (e.losses) }));
    }
    cells
}

/// A mean ratio; its interval below it, and a sign where it is surely less or more than 1.
pub(super) fn ratio(effect: &Effect) -> Markup {
    let (class, sign, means) = match effect.verdict() {
        Verdict::Better => ("better", "▾", "surely less"),
        Verdict::Worse => ("worse", "▴", "surely more"),
        Verdict::Same => ("", "=", "the same to within 1 %"),
        Verdict::Open => ("", "", ""),
    };
    let [low, high] = effect.interval.map(digits);
    html! {
        span class=(class) {
            (digits(effect.mean)) " " span.sign aria-hidden="true" { (sign) }
            @if !means.is_empty() { span.aside { " " (means) } }
        }
        @if effect.n > 1 { span.interval { (low) "–" (high) } }
    }
}

/// How numbers and signs are to be read.
pub(super) fn legend() -> Markup {
    html! {
        p.note {
            strong { "How to read the figures. " }
            "They are ratios to the base, geometric means over pairs of the same rays: 0.80 is a fifth less. In sentences the ratio stands in brackets, "
            "then its 95\u{a0}% interval; in tables the interval stands below it. ▾ the interval lies wholly below 1: surely less; ▴ wholly above 1: "
            "surely more; = within 1\u{a0}% of it. “slower” counts the pairs whose own interval, over their rounds, lies wholly above 1."
        }
    }
}

impl Key {
    fn name(self) -> &'static str {
        match self {
            Self::Mode => "rays",
            Self::Class => "class",
            Self::Kind => "kind of scene",
            Self::Setting => "setting",
            Self::Spec => "spec",
            Self::Base => "base",
        }
    }

    fn label(self, pair: &Pair<'_>) -> String {
        match self {
            Self::Mode => pair.job.mode.name().to_owned(),
            Self::Class => words::class(pair.class).to_owned(),
            Self::Kind => words::kind(pair.kind).to_owned(),
            Self::Setting => pair.setting.to_owned(),
            Self::Spec => pair.spec.to_string(),
            Self::Base => pair.base.to_string(),
        }
    }

    fn cell(self, label: &str) -> Markup {
        match self {
            Self::Spec | Self::Base => html! { code { (label) } },
            _ => html! { (label) },
        }
    }
}

type Rank = (Option<Mode>, Option<(bool, Option<RayClass>)>, Option<rdh_scene::Kind>, Option<f64>);

/// Only what is grouped by decides the order; a stable sort leaves the rest as it came.
fn rank(group: &Group<'_, '_>, keys: &[Key]) -> Rank {
    let first = group.pairs[0];
    let has = |key: Key| keys.contains(&key);
    (
        has(Key::Mode).then_some(first.job.mode),
        has(Key::Class).then_some((first.class.is_none(), first.class)),
        has(Key::Kind).then_some(first.kind),
        // What has no place on the axis stands after it.
        has(Key::Setting).then_some(first.x.unwrap_or(f64::INFINITY)),
    )
}
