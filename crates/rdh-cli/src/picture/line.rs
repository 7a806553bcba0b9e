//! Smooth lines.

use super::canvas::{Canvas, Rgb};

/// How a line looks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub colour: Rgb,
    /// In pixels.
    pub width: f64,
    /// 1 covers what is below.
    pub alpha: f64,
}

/// Draws a straight line between two points, given in pixels, pixel centres at halves.
///
/// Walks along the longer axis and covers, across it, the pixels that the pen touches, by how far it does.
pub(crate) fn draw_line(canvas: &mut Canvas, from: [f64; 2], to: [f64; 2], pen: Pen) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let steep = dy.abs() > dx.abs();
    let (a, b) = if steep { (swap(from), swap(to)) } else { (from, to) };
    let (a, b) = if a[0] <= b[0] { (a, b) } else { (b, a) };
    let slope = if b[0] > a[0] { (b[1] - a[1]) / (b[0] - a[0]) } else { 0.0 };
    // A slanted pen is wider when measured across the axis.
    let half = 0.5 * pen.width * slope.hypot(1.0);
    let limit = if steep { canvas.height() } else { canvas.width() } as f64;
    let (first, last) = (a[0].max(0.0).floor(), b[0].min(limit).floor());
    let mut along = first;
    while along <= last {
        let covered = (b[0].min(along + 1.0) - a[0].max(along)).clamp(0.0, 1.0);
        let middle = a[1] + slope * (along + 0.5 - a[0]);
        for across in (middle - half - 0.5).floor() as i64..=(middle + half + 0.5).floor() as i64 {
            let touched = (half + 0.5 - (across as f64 + 0.5 - middle).abs()).clamp(0.0, pen.width.min(1.0));
            let (x, y) = if steep { (across, along as i64) } else { (along as i64, across) };
            canvas.blend(x, y, pen.colour, pen.alpha * touched * covered);
        }
        along += 1.0;
    }
}

/// Draws a filled disc.
pub(crate) fn draw_disc(canvas: &mut Canvas, centre: [f64; 2], radius: f64, colour: Rgb) {
    let around = |c: f64| (c - radius - 1.0).floor() as i64..=(c + radius + 1.0).floor() as i64;
    for y in around(centre[1]) {
        for x in around(centre[0]) {
            let distance = (x as f64 + 0.5 - centre[0]).hypot(y as f64 + 0.5 - centre[1]);
            canvas.blend(x, y, colour, (radius + 0.5 - distance).clamp(0.0, 1.0));
        }
    }
}

fn swap(p: [f64; 2]) -> [f64; 2] {
    [p[1], p[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Rgb = Rgb(255, 255, 255);
    const PEN: Pen = Pen { colour: Rgb(0, 0, 0), width: 1.0, alpha: 1.0 };

    /// How much ink is on the canvas, in full pixels.
    fn ink(canvas: &Canvas) -> f64 {
        canvas.pixels().iter().map(|p| 1.0 - f64::from(p.0) / 255.0).sum()
    }

    #[test]
    fn ink_is_length_times_width_in_all_directions() {
        for to in [[35.0, 20.5], [20.5, 35.0], [5.0, 20.5], [32.0, 29.0], [11.0, 33.0], [20.0, 4.0]] {
            let mut canvas = Canvas::new(40, 40, WHITE);
            draw_line(&mut canvas, [20.5, 20.5], to, PEN);
            let length = (to[0] - 20.5f64).hypot(to[1] - 20.5);
            assert!((ink(&canvas) / length - 1.0).abs() < 0.08, "{to:?}: {} of {length}", ink(&canvas));
        }
    }

    #[test]
    fn a_line_far_outside_costs_nothing_and_draws_nothing() {
        let mut canvas = Canvas::new(8, 8, WHITE);
        draw_line(&mut canvas, [-1e12, 100.0], [1e12, 100.0], PEN);
        assert_eq!(ink(&canvas), 0.0);
    }

    #[test]
    fn a_disc_has_its_area() {
        let mut canvas = Canvas::new(40, 40, WHITE);
        draw_disc(&mut canvas, [20.0, 20.0], 10.0, PEN.colour);
        assert!((ink(&canvas) / (std::f64::consts::PI * 100.0) - 1.0).abs() < 0.02, "{}", ink(&canvas));
    }
}
