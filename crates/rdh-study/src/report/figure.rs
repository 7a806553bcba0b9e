//! Figures: a plot in two widths, of which the page shows the one that fits, with its caption.

use maud::{Markup, html};

use super::svg::key;

/// What a plot is drawn for, in pixels: a phone, and all else.
const NARROW: f64 = 330.0;
const WIDE: f64 = 720.0;

/// A plot with a caption; `draw` draws it for a width.
pub(super) fn figure(caption: &Markup, legend: &[(usize, String)], draw: impl Fn(f64) -> Markup) -> Markup {
    html! {
        figure {
            @if legend.len() > 1 { ul.legend { @for (series, name) in legend { li { (key(*series)) " " (name) } } } }
            div.wide { (draw(WIDE)) }
            div.narrow { (draw(NARROW)) }
            figcaption { (caption) }
        }
    }
}
