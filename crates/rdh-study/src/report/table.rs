//! Tables of effects, and tables in general: each scrolls within its own box where there is no room.

use maud::{Markup, html};
use rdh::{RayClass, Spec};
use rdh_scene::Kind;

use super::effect::{Effect, Verdict};
use super::pairs::{Metric, Pair};
use super::words::{self, digits};
use crate::integrate::Mode;

/// A table: heads beginning with `>` stand over numbers; a row of a single cell is a heading over the rows below it.
pub(super) fn table(caption: &str, heads: &[&str], rows: &[Vec<Markup>]) -> Markup {
    html! {
        p.caption aria-hidden="true" { (caption) }
        div.table tabindex="0" role="region" aria-label=(caption) {
            table aria-label=(caption) {
                thead { tr { @for (i, head) in heads.iter().enumerate() {
                    th scope="col" class=[number(heads, i)] { (head.trim_start_matches('>')) }
                } } }
                tbody { @for row in rows { (table_row(heads, row)) } }
            }
        }
    }
}

fn table_row(heads: &[&str], row: &[Markup]) -> Markup {
    match row {
        [heading] if heads.len() > 1 => html! { tr { th.over scope="rowgroup" colspan=(heads.len()) { (heading) } } },
        cells => html! { tr { @for (i, cell) in cells.iter().enumerate() { td class=[number(heads, i)] { (cell) } } } },
    }
}

fn number(heads: &[&str], column: usize) -> Option<&'static str> {
    heads.get(column).is_some_and(|h| h.starts_with('>')).then_some("n")
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

/// Groups pairs: by mode and class in their order; settings by family in order of appearance, in it by the axis.
pub(super) fn group<'p, 'r>(pairs: &[&'p Pair<'r>], keys: &[Key]) -> Vec<Group<'p, 'r>> {
    let mut groups: Vec<Group<'p, 'r>> = Vec::new();
    for &pair in pairs {
        let labels: Vec<String> = keys.iter().map(|k| k.label(pair)).collect();
        match groups.iter_mut().find(|g| g.labels == labels) {
            Some(group) => group.pairs.push(pair),
            None => groups.push(Group { labels, pairs: vec![pair] }),
        }
    }
    let mut families: Vec<String> = Vec::new();
    for pair in pairs {
        let name = family(pair);
        if !families.contains(&name) {
            families.push(name);
        }
    }
    let rank = |g: &Group<'_, '_>| rank(g, keys, &families);
    groups.sort_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal));
    groups
}

/// A table of effects, one line a group. What all groups agree in is left out; the first key that varies makes headings if there
/// are others, and bases stand below the specs that are compared with them.
pub(super) fn effects(caption: &str, pairs: &[&Pair<'_>], keys: &[Key], metrics: &[Metric]) -> Markup {
    effects_of(caption, &group(pairs, keys), keys, metrics)
}

fn effects_of(caption: &str, groups: &[Group<'_, '_>], keys: &[Key], metrics: &[Metric]) -> Markup {
    let varies = |i: &usize| groups.iter().any(|g| g.labels[*i] != groups[0].labels[*i]);
    let varying: Vec<usize> = (0..keys.len()).filter(varies).collect();
    let bases = varying.iter().any(|&i| keys[i] == Key::Base);
    let columns: Vec<usize> = varying.into_iter().filter(|&i| keys[i] != Key::Base).collect();
    let (heading, columns) = match columns.as_slice() {
        [] => (None, vec![0]),
        [first, others @ ..] if !others.is_empty() && stands_over_some(groups, *first) => {
            (Some(*first), others.to_vec())
        }
        all => (None, all.to_vec()),
    };
    let mut rows: Vec<Vec<Markup>> = Vec::new();
    for (i, g) in groups.iter().enumerate() {
        let above = i.checked_sub(1).map(|i| &groups[i]);
        if let Some(k) = heading.filter(|&k| above.is_none_or(|a| a.labels[k] != g.labels[k])) {
            rows.push(vec![keys[k].cell(&g.labels[k])]);
        }
        let above = above.filter(|a| heading.is_none_or(|k| a.labels[k] == g.labels[k]));
        let cells = columns.iter().scan(true, |again, &k| Some(label_cell(g, above, keys, k, bases, again)));
        rows.push(cells.chain(effect_cells(g, metrics)).collect());
    }
    let mut heads: Vec<String> = columns.iter().map(|&i| keys[i].name().to_owned()).collect();
    heads.push(">pairs".to_owned());
    heads.extend(metrics.iter().map(|m| format!(">{}", m.name())));
    if metrics.contains(&Metric::Time) {
        heads.push(">slower".to_owned());
    }
    table(caption, &heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

/// Whether headings by this key would have more than a line or so below them.
fn stands_over_some(groups: &[Group<'_, '_>], key: usize) -> bool {
    let headings = groups.chunk_by(|a, b| a.labels[key] == b.labels[key]).count();
    2 * groups.len() >= 3 * headings
}

/// A label; what stands in the line above is there for those who hear the table, not for eyes.
fn label_cell(
    g: &Group<'_, '_>,
    above: Option<&Group<'_, '_>>,
    keys: &[Key],
    k: usize,
    bases: bool,
    again: &mut bool,
) -> Markup {
    *again &= above.is_some_and(|a| a.labels[k] == g.labels[k]);
    let cell = keys[k].cell(&g.labels[k]);
    if *again {
        return html! { span.aside { (cell) } };
    }
    html! { (cell) @if bases && keys[k] == Key::Spec { (against(&g.pairs[0].base)) } }
}

/// What a spec is compared with, in small letters below it.
pub(super) fn against(base: &Spec) -> Markup {
    html! { span.interval { "against " code { (base) } } }
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
        Verdict::Same => ("", "=", "the same to within 1\u{a0}%"),
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

/// The setting, without its number if it has a place on the axis: settings that differ in that alone are a family.
pub(super) fn family(pair: &Pair<'_>) -> String {
    if pair.x.is_none() {
        return pair.setting.to_owned();
    }
    let is_word = |word: &&str| !word.is_empty() && word.parse::<f64>().is_err();
    pair.setting.split([' ', ':', '=']).filter(is_word).collect::<Vec<_>>().join(" ")
}

type Rank = (Option<Mode>, Option<(bool, Option<RayClass>)>, Option<Kind>, Option<(usize, Option<f64>)>);

/// Only what is grouped by decides the order; a stable sort leaves the rest as it came.
fn rank(group: &Group<'_, '_>, keys: &[Key], families: &[String]) -> Rank {
    let first = group.pairs[0];
    let has = |key: Key| keys.contains(&key);
    let place = || (families.iter().position(|f| *f == family(first)).unwrap_or_default(), first.x);
    (
        has(Key::Mode).then_some(first.job.mode),
        has(Key::Class).then_some((first.class.is_none(), first.class)),
        has(Key::Kind).then_some(first.kind),
        has(Key::Setting).then(place),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_one_cell_is_a_heading_over_the_others() {
        let cell = |words: &str| html! { (words) };
        let html = table("t", &["a", ">b"], &[vec![cell("head")], vec![cell("x"), cell("1")]]).into_string();
        assert!(html.contains(r#"<th class="over" scope="rowgroup" colspan="2">head</th>"#), "{html}");
        assert!(html.contains(r#"<td>x</td><td class="n">1</td>"#), "{html}");
        assert!(html.contains(r#"<th scope="col">a</th><th scope="col" class="n">b</th>"#), "{html}");
    }
}
