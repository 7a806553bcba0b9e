//! Plots as inline SVG. Colours and text sizes come from the page's style sheet, so that dark mode and paper work.

mod axis;
mod forest;
mod lines;
mod scatter;
mod strip;

use maud::{Markup, html};

pub(super) use axis::{Axis, short};
pub(super) use forest::{Entry, forest};
pub(super) use lines::{Line, Upwards, lines};
pub(super) use scatter::{Dot, scatter};
pub(super) use strip::strip;

/// Series that can be told apart, by shape and by colour.
pub(super) const SERIES: usize = 6;

/// The height of a line of small text, in pixels.
pub(in crate::report) const LINE: f64 = 17.0;

/// How words are set against their place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The root of a drawing: its size, and what it shows in words.
pub(super) fn root(width: f64, height: f64, says: &str, inside: Markup) -> Markup {
    let view = format!("0 0 {width:.0} {height:.0}");
    html! {
        svg.plot viewBox=(view) width=(format!("{width:.0}")) height=(format!("{height:.0}")) role="img" aria-label=(says) {
            (inside)
        }
    }
}

/// Words whose base line is at `y`.
pub(super) fn text(x: f64, y: f64, anchor: Anchor, class: &str, words: &str) -> Markup {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    html! { text class=(class) x=(px(x)) y=(px(y)) text-anchor=(anchor) { (words) } }
}

/// A straight line.
pub(super) fn line(class: &str, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> Markup {
    html! { line class=(class) x1=(px(x1)) y1=(px(y1)) x2=(px(x2)) y2=(px(y2)) {} }
}

/// The mark of a series: each has a shape of its own, so that nothing is said by colour alone.
pub(super) fn marker(series: usize, x: f64, y: f64, size: f64, says: Option<&str>) -> Markup {
    let class = format!("mark s{}", series % SERIES);
    html! {
        path class=(class) d=(shape(series, x, y, size)) { @if let Some(words) = says { title { (words) } } }
    }
}

/// The mark alone, for legends in running text.
pub(super) fn key(series: usize) -> Markup {
    html! { svg.key viewBox="0 0 14 14" width="14" height="14" aria-hidden="true" { (marker(series, 7.0, 7.0, 5.0, None)) } }
}

fn shape(series: usize, x: f64, y: f64, r: f64) -> String {
    let polygon = |corners: &[[f64; 2]]| {
        let corner = |c: &[f64; 2]| format!("{} {}", px(x + r * c[0]), px(y + r * c[1]));
        format!("M{}Z", corners.iter().map(corner).collect::<Vec<_>>().join("L"))
    };
    match series % SERIES {
        0 => {
            let (left, r, dx) = (px(x - r), px(r), px(2.0 * r));
            format!("M{left} {}a{r} {r} 0 1 0 {dx} 0a{r} {r} 0 1 0 -{dx} 0Z", px(y))
        }
        1 => polygon(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        2 => polygon(&[[0.0, -1.2], [1.15, 0.85], [-1.15, 0.85]]),
        3 => polygon(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
        4 => polygon(&[[0.0, 1.2], [1.15, -0.85], [-1.15, -0.85]]),
        _ => {
            let (a, b) = (0.4, 1.15);
            polygon(&[
                [-a, -b],
                [a, -b],
                [a, -a],
                [b, -a],
                [b, a],
                [a, a],
                [a, b],
                [-a, b],
                [-a, a],
                [-b, a],
                [-b, -a],
                [-a, -a],
            ])
        }
    }
}

/// A length with a tenth of a pixel: enough for eyes, and short.
pub(super) fn px(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// About how wide small text will be; fonts differ, so this is on the safe side.
pub(super) fn width_of(words: &str) -> f64 {
    7.0 * words.chars().count() as f64
}
