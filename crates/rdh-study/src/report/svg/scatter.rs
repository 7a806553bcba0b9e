//! Scatter plots: one dot a view, ratios upwards.

use maud::{Markup, html};

use super::{Anchor, Axis, marker, root, text};

/// One dot.
#[derive(Debug, Clone)]
pub(in crate::report) struct Dot {
    pub x: f64,
    /// A ratio.
    pub y: f64,
    pub series: usize,
    /// Which it is, for those who point at it.
    pub says: String,
}

const TOP: f64 = 26.0;
const FOOT: f64 = 44.0;

/// Draws dots over two axes; `labels` name them, across and upwards.
pub(in crate::report) fn scatter(dots: &[Dot], [across, upwards]: [&str; 2], says: &str, width: f64) -> Markup {
    let height = (0.56 * width).clamp(230.0, 340.0);
    let bottom = height - FOOT;
    let y = Axis::ratios(dots.iter().map(|d| d.y), [bottom, TOP]);
    let left = y.room_beside();
    let x = Axis::fitting(dots.iter().map(|d| d.x), [left, width - 8.0]);
    let inside = html! {
        (x.below(TOP, bottom))
        (y.beside(left, width - 8.0))
        (text(0.0, 13.0, Anchor::Start, "axis", upwards))
        (text(width - 8.0, bottom + 36.0, Anchor::End, "axis", across))
        @for dot in dots { (marker(dot.series, x.at(dot.x), y.at(dot.y), 3.6, Some(&dot.says))) }
    };
    root(width, height, says, inside)
}
