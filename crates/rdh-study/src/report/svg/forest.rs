//! Forest plots: means with their intervals, one a line, on a common axis of ratios.

use maud::{Markup, html};

use super::{Anchor, Axis, LINE, SERIES, line, marker, root, text, width_of};
use crate::report::effect::Effect;

/// A line of a forest plot.
#[derive(Debug, Clone)]
pub(in crate::report) enum Entry {
    /// A heading over the lines below it.
    Head(String),
    /// A mean with its interval.
    Mean { label: String, series: usize, effect: Effect },
}

const ROW: f64 = 24.0;
const SIDE: f64 = 4.0;
/// Below the last line: numbers, and what they mean.
const FOOT: f64 = 42.0;
/// `0.78 (0.74 to 0.82)`
const NUMBERS: f64 = 138.0;

/// Draws the lines; where there is little room each label stands above its interval.
pub(in crate::report) fn forest(entries: &[Entry], axis_label: &str, says: &str, width: f64) -> Markup {
    let labels = entries.iter().map(|e| width_of(label(e))).fold(60.0, f64::max);
    let beside = width - labels - NUMBERS > 200.0;
    let left = if beside { labels + 14.0 } else { SIDE + 6.0 };
    let right = width - NUMBERS;
    let axis = Axis::ratios(entries.iter().flat_map(ends), [left, right]);
    let places = places(entries, beside, width);
    let bottom = places.last().map_or(ROW, |y| y + 12.0);
    let inside = html! {
        (axis.below(2.0, bottom))
        @for (entry, &y) in entries.iter().zip(&places) { (draw(entry, y, &axis, beside, width)) }
        (text(left, bottom + 35.0, Anchor::Start, "axis", axis_label))
    };
    root(width, bottom + FOOT, says, inside)
}

/// The middle of each line of the plot.
fn places(entries: &[Entry], beside: bool, width: f64) -> Vec<f64> {
    let mut y = 2.0;
    let place = |entry: &Entry| {
        let above = match entry {
            Entry::Head(words) => LINE * (wrapped(words, width).len() - 1) as f64,
            Entry::Mean { label, .. } if !beside => LINE * wrapped(label, width).len() as f64,
            Entry::Mean { .. } => 0.0,
        };
        y += ROW + above;
        y - 0.5 * ROW
    };
    entries.iter().map(place).collect()
}

fn draw(entry: &Entry, y: f64, axis: &Axis, beside: bool, width: f64) -> Markup {
    match entry {
        Entry::Head(words) => stacked(y + 4.5, "head", &wrapped(words, width)),
        Entry::Mean { label, series, effect } => {
            let [low, high] = effect.interval;
            html! {
                @if beside { (text(SIDE + 8.0, y + 4.5, Anchor::Start, "label", label)) }
                @else { (stacked(y - 0.5 * ROW, "label", &wrapped(label, width))) }
                (line(&format!("whisker s{}", series % SERIES), [axis.at(low), y], [axis.at(high), y]))
                (marker(*series, axis.at(effect.mean), y, 4.6, None))
                (text(width - SIDE, y + 4.5, Anchor::End, "number", &numbers(effect)))
            }
        }
    }
}

/// Lines of words above each other, the last of them at `y`.
fn stacked(y: f64, class: &str, lines: &[String]) -> Markup {
    let at = |i: usize| y - LINE * (lines.len() - 1 - i) as f64;
    html! { @for (i, words) in lines.iter().enumerate() { (text(SIDE, at(i), Anchor::Start, class, words)) } }
}

/// Words in lines that fit.
fn wrapped(words: &str, width: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in words.split(' ') {
        let last = lines.len() - 1;
        if lines[last].is_empty() || width_of(&lines[last]) + width_of(word) + 7.0 <= width - 2.0 * SIDE {
            let space = if lines[last].is_empty() { "" } else { " " };
            lines[last] += &format!("{space}{word}");
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

fn numbers(effect: &Effect) -> String {
    let [low, high] = effect.interval.map(digits);
    format!("{} ({low} to {high})", digits(effect.mean))
}

fn digits(ratio: f64) -> String {
    if ratio >= 9.95 { format!("{ratio:.1}") } else { format!("{ratio:.2}") }
}

fn label(entry: &Entry) -> &str {
    match entry {
        // A heading may reach into the plot.
        Entry::Head(_) => "",
        Entry::Mean { label, .. } => label,
    }
}

fn ends(entry: &Entry) -> Vec<f64> {
    match entry {
        Entry::Head(_) => Vec::new(),
        Entry::Mean { effect, .. } => effect.interval.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_words_are_wrapped_and_none_is_lost() {
        let words = "as many uniform lines instead of the view's rays";
        let lines = wrapped(words, 330.0);
        assert!(lines.len() == 2 && lines.iter().all(|l| width_of(l) <= 330.0), "{lines:?}");
        assert_eq!(lines.join(" "), words);
        assert_eq!(wrapped("", 330.0), [""]);
    }
}
