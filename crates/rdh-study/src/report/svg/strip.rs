//! Strips: every pair as a dot on an axis of ratios, one row a group, so that losses can be seen as well as means.

use maud::{Markup, html};

use super::{Anchor, Axis, Dot, LINE, marker, root, text};

const SIDE: f64 = 6.0;
const FOOT: f64 = 42.0;
const RADIUS: f64 = 3.4;

/// Draws groups of dots, their heights without meaning: dots that would hide each other are stacked. A dot's `y` is its
/// ratio.
pub(in crate::report) fn strip(groups: &[(String, Vec<Dot>)], axis_label: &str, says: &str, width: f64) -> Markup {
    let all = groups.iter().flat_map(|g| &g.1);
    let axis = Axis::ratios(all.map(|d| d.y), [SIDE + RADIUS, width - SIDE - RADIUS]);
    let mut rows = Vec::new();
    let mut y = 0.0;
    for (name, dots) in groups {
        let stacked = stack(dots, &axis);
        let deepest = stacked.iter().map(|s| s.1.abs()).fold(RADIUS, f64::max);
        let middle = y + LINE + 8.0 + deepest;
        rows.push((name, y + LINE - 3.0, middle, stacked));
        y = middle + deepest + 10.0;
    }
    let inside = html! {
        (axis.below(2.0, y))
        @for (name, name_y, middle, dots) in &rows {
            (text(SIDE, *name_y, Anchor::Start, "head", name))
            @for (dot, offset) in dots {
                (marker(dot.series, axis.at(dot.y), middle + offset, RADIUS, Some(&dot.says)))
            }
        }
        (text(SIDE, y + 35.0, Anchor::Start, "axis", axis_label))
    };
    root(width, y + FOOT, says, inside)
}

/// How far above or below the middle each dot goes so that it touches none before it: a simple swarm.
fn stack<'d>(dots: &'d [Dot], axis: &Axis) -> Vec<(&'d Dot, f64)> {
    let mut order: Vec<&Dot> = dots.iter().collect();
    order.sort_by(|a, b| a.y.total_cmp(&b.y));
    let mut placed: Vec<(&Dot, f64)> = Vec::new();
    for dot in order {
        let free = |offset: f64| {
            let near = placed.iter().rev().take(64);
            near.map(|(other, o)| (axis.at(other.y) - axis.at(dot.y)).hypot(o - offset)).all(|d| d >= 2.0 * RADIUS)
        };
        let levels = (0..40).flat_map(|i| [f64::from(i), -f64::from(i)]).map(|i| i * RADIUS);
        placed.push((dot, levels.clone().find(|o| free(*o)).unwrap_or(0.0)));
    }
    placed
}
