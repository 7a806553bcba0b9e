//! From numbers to words, so that what the report says is what the data say.

use rdh::RayClass;
use rdh_scene::Kind;

use super::effect::{Effect, Verdict};
use super::pairs::Metric;
use crate::integrate::Mode;

/// A number as short as it can be said: `0.25`, `7`, `1.5k`, `20M`.
pub fn short_number(value: f64) -> String {
    let (scaled, unit) = match value.abs() {
        size if size >= 1e6 => (value / 1e6, "M"),
        size if size >= 1e4 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    // Three decimals are enough for ticks; zeros at the end say nothing.
    let digits = format!("{scaled:.3}");
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    format!("{}{unit}", if digits == "-0" { "0" } else { digits })
}

/// `22 % fewer steps (0.78, 0.74–0.82)`: in brackets the ratio and its 95 % interval; or that there is no difference.
pub(super) fn said(effect: &Effect, metric: Metric) -> String {
    format!("{} ({})", change(effect, metric), figures(effect))
}

/// `22 % fewer steps`, `no clear difference in time`.
pub(super) fn change(effect: &Effect, metric: Metric) -> String {
    let what = noun(metric);
    match effect.verdict() {
        Verdict::Same => format!("the same {what} to within 1\u{a0}%"),
        Verdict::Open if effect.n > 1 => format!("no clear difference in {what}"),
        _ => change_of(effect.mean, metric),
    }
}

/// `22 % fewer steps`, whether that is sure or not.
pub(super) fn change_of(ratio: f64, metric: Metric) -> String {
    let (what, counted) = (noun(metric), matches!(metric, Metric::Steps | Metric::Tests | Metric::References));
    let less = if counted { "fewer" } else { "less" };
    match ratio {
        r if r >= 2.0 => format!("{} times the {what}", digits(r)),
        r if r >= 1.0 => format!("{} more {what}", percent(r - 1.0)),
        r => format!("{} {less} {what}", percent(1.0 - r)),
    }
}

/// `0.78, 0.74–0.82`
pub(super) fn figures(effect: &Effect) -> String {
    let [low, high] = effect.interval.map(digits);
    match effect.n {
        1 => format!("{}, one view", digits(effect.mean)),
        _ => format!("{}, {low}–\u{2060}{high}", digits(effect.mean)),
    }
}

/// A ratio with as many digits as mean something.
pub(super) fn digits(ratio: f64) -> String {
    match ratio {
        r if !r.is_finite() => "–".to_owned(),
        r if r >= 99.5 => format!("{r:.0}"),
        r if r >= 9.95 => format!("{r:.1}"),
        r if (0.985..1.015).contains(&r) => format!("{r:.3}"),
        r => format!("{r:.2}"),
    }
}

/// A share in per cent; below one tenth of it with one more digit.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    // No zero has a sign.
    let percent = if percent.abs() < 0.05 { 0.0 } else { percent };
    if percent.abs() < 9.95 { format!("{percent:.1}\u{a0}%") } else { format!("{percent:.0}\u{a0}%") }
}

/// A ratio as a signed change, as the paper says it: `−8 %`.
pub(super) fn signed(ratio: f64) -> String {
    let percent = 100.0 * (ratio - 1.0);
    let digits = if percent.abs() < 9.95 { format!("{:.1}", percent.abs()) } else { format!("{:.0}", percent.abs()) };
    match digits.as_str() {
        "0.0" => "0\u{a0}%".to_owned(),
        _ if percent < 0.0 => format!("−{digits}\u{a0}%"),
        _ => format!("+{digits}\u{a0}%"),
    }
}

/// A count with its noun: `1 view`, `3 views`.
pub(super) fn count(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{} {noun}s", grouped(n as f64)) }
}

/// A whole number with its thousands apart.
pub(super) fn grouped(value: f64) -> String {
    let digits = format!("{:.0}", value.abs());
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    if value < 0.0 { format!("−{text}") } else { text }
}

/// A mode's rays in words, at the beginning of a sentence.
pub(super) fn rays_of(mode: Mode) -> &'static str {
    match mode {
        Mode::Primary => "Primary rays",
        Mode::Whitted => "Whitted ray tracing",
        Mode::Path => "Diffuse paths",
        Mode::Ao => "Ambient occlusion",
        Mode::Lidar => "A scanner’s rays",
    }
}

/// A class by its name, or all.
pub(super) fn class(class: Option<RayClass>) -> &'static str {
    class.map_or("all", RayClass::name)
}

/// A kind of scene by its name.
pub(super) fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Open => "open",
        Kind::Interior => "interior",
        Kind::Dense => "dense",
    }
}

/// The words with a capital first letter; a letter that stands alone is a symbol, and stays.
pub(super) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    let Some(first) = letters.next() else { return String::new() };
    if letters.clone().next().is_some_and(char::is_alphabetic) {
        first.to_uppercase().chain(letters).collect()
    } else {
        words.to_owned()
    }
}

/// Joins parts as prose does: `a, b and c`.
pub(super) fn list(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn noun(metric: Metric) -> &'static str {
    match metric {
        Metric::Steps => "steps",
        Metric::Tests => "tests",
        Metric::Time => "time",
        Metric::Build => "build time",
        Metric::BuildAndRays => "time for the build and its training rays",
        Metric::Frame => "time for build, training rays and this frame",
        Metric::Bytes => "memory",
        Metric::References => "references",
        Metric::Worst => "cost at the 99.9th percentile",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(mean: f64, interval: [f64; 2]) -> Effect {
        Effect { n: 9, scenes: 3, mean, interval, least: mean, most: mean, wins: 0, losses: 0 }
    }

    #[test]
    fn numbers_are_short() {
        let said = [0.25, 7.0, 15_000.0, 2e7, -0.00001, 1234.5].map(short_number);
        assert_eq!(said, ["0.25", "7", "15k", "20M", "0", "1234.5"]);
    }

    #[test]
    fn words_follow_the_interval() {
        let steps = |mean, interval| change(&effect(mean, interval), Metric::Steps);
        assert_eq!(steps(0.78, [0.74, 0.82]), "22\u{a0}% fewer steps");
        assert_eq!(steps(1.03, [1.01, 1.06]), "3.0\u{a0}% more steps");
        assert_eq!(steps(1.001, [0.995, 1.004]), "the same steps to within 1\u{a0}%");
        assert_eq!(steps(0.97, [0.9, 1.02]), "no clear difference in steps");
        assert_eq!(change(&effect(3.1, [2.9, 3.3]), Metric::Build), "3.10 times the build time");
        assert_eq!(change(&effect(0.8, [0.7, 0.9]), Metric::Bytes), "20\u{a0}% less memory");
    }

    #[test]
    fn figures_are_set_as_in_print() {
        assert_eq!([0.92, 1.0, 1.125, 0.9996].map(signed), ["−8.0\u{a0}%", "0\u{a0}%", "+12\u{a0}%", "0\u{a0}%"]);
        assert_eq!(
            [1.0, 999.0, 1000.0, 1_234_567.0].map(grouped),
            ["1", "999", "1\u{202f}000", "1\u{202f}234\u{202f}567"]
        );
        assert_eq!(["p measured", "steps", ""].map(capital), ["p measured", "Steps", ""]);
        assert_eq!(list(&["a".into(), "b".into(), "c".into()]), "a, b and c");
        assert_eq!([count(1, "view"), count(2, "view")], ["1 view", "2 views"]);
    }
}
