//! Lines with bands: a mean and its interval over a quantity.

use maud::{Markup, html};

use super::{Anchor, Axis, SERIES, marker, px, root, text};

/// One line of a plot.
#[derive(Debug, Clone)]
pub(in crate::report) struct Line {
    pub series: usize,
    /// What stands in the legend.
    pub name: String,
    /// `[x, y, low, high]`, in the order of x.
    pub points: Vec<[f64; 4]>,
}

/// What the values upwards are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report) enum Upwards {
    Ratios,
    Values,
}

const TOP: f64 = 26.0;
const FOOT: f64 = 44.0;

/// Draws lines over two axes; `labels` name them, across and upwards.
pub(in crate::report) fn lines(
    lines: &[Line],
    upwards_are: Upwards,
    [across, upwards]: [&str; 2],
    says: &str,
    width: f64,
) -> Markup {
    let height = (0.52 * width).clamp(230.0, 330.0);
    let bottom = height - FOOT;
    let points = || lines.iter().flat_map(|l| &l.points);
    let values = points().flat_map(|p| [p[1], p[2], p[3]]);
    let y = match upwards_are {
        Upwards::Ratios => Axis::ratios(values, [bottom, TOP]),
        Upwards::Values => Axis::fitting(values, [bottom, TOP]),
    };
    let left = y.room_beside();
    let x = Axis::fitting(points().map(|p| p[0]), [left, width - 8.0]);
    let inside = html! {
        (x.below(TOP, bottom))
        (y.beside(left, width - 8.0))
        (text(0.0, 13.0, Anchor::Start, "axis", upwards))
        (text(width - 8.0, bottom + 36.0, Anchor::End, "axis", across))
        @for line in lines { (band(line, &x, &y)) }
        @for line in lines { (stroke(line, &x, &y)) }
    };
    root(width, height, says, inside)
}

fn band(line: &Line, x: &Axis, y: &Axis) -> Markup {
    let up = line.points.iter().map(|p| [p[0], p[2]]);
    let back = line.points.iter().rev().map(|p| [p[0], p[3]]);
    html! { path class=(format!("band s{}", line.series % SERIES)) d=(format!("{}Z", path(up.chain(back), x, y))) {} }
}

fn stroke(line: &Line, x: &Axis, y: &Axis) -> Markup {
    let along = line.points.iter().map(|p| [p[0], p[1]]);
    html! {
        path class=(format!("stroke s{}", line.series % SERIES)) d=(path(along, x, y)) {}
        @for p in &line.points {
            (marker(line.series, x.at(p[0]), y.at(p[1]), 3.8, Some(&format!("{}: {:.3} at {}", line.name, p[1], p[0]))))
        }
    }
}

fn path(points: impl Iterator<Item = [f64; 2]>, x: &Axis, y: &Axis) -> String {
    let place = |p: [f64; 2]| format!("{} {}", px(x.at(p[0])), px(y.at(p[1])));
    format!("M{}", points.map(place).collect::<Vec<_>>().join("L"))
}
