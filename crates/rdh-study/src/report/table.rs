//! Tables of effects, and tables in general: each scrolls within its own box where there is no room.

use maud::{Markup, html};
use rdh::Spec;

use super::effect::{Effect, Verdict};
use super::group::{Group, Key, group};
use super::pairs::{Metric, Pair};
use super::words::digits;

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
