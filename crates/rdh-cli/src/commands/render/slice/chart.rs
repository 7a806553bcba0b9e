//! From the plane of a slice to pixels.

use std::ops::RangeInclusive;

use rdh::Aabb;

use super::Plane;
use super::section::CutCell;
use crate::args::Size;
use crate::picture::{Canvas, ColourScale, Rgb};

/// A map of the scene's box, seen along one axis, as large as fits into the size asked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chart {
    pub(super) width: usize,
    pub(super) height: usize,
    low: [f64; 2],
    high: [f64; 2],
    pixels_per_unit: f64,
}

/// Blank pixels around the scene's box.
const BORDER: f64 = 6.0;

impl Chart {
    pub(super) fn new(bounds: &Aabb, axis: usize, room: Size) -> Self {
        let axes = Plane::axes(axis);
        let (low, high) = (axes.map(|a| f64::from(bounds.min[a])), axes.map(|a| f64::from(bounds.max[a])));
        let room = [room.width, room.height].map(|n| (n as f64 - 2.0 * BORDER).max(1.0));
        // A flat scene is given some height, so that there is something to see.
        let extent = [0, 1].map(|i| (high[i] - low[i]).max(1e-3 * f64::from(bounds.diagonal())).max(1e-30));
        let pixels_per_unit = (room[0] / extent[0]).min(room[1] / extent[1]);
        let [width, height] = extent.map(|e| (e * pixels_per_unit + 2.0 * BORDER).ceil() as usize);
        Self { width, height, low, high, pixels_per_unit }
    }

    /// Where a point of the plane is on the picture.
    pub(super) fn place(&self, p: [f64; 2]) -> [f64; 2] {
        let x = BORDER + (p[0] - self.low[0]) * self.pixels_per_unit;
        let y = BORDER + (self.high[1] - p[1]) * self.pixels_per_unit;
        [x, y]
    }

    /// Paints cells by the number of their triangles, and their sides. Sides of cells of a few pixels are faint, so that
    /// small cells don't merge into one dark blot.
    pub(super) fn paint_cells(&self, canvas: &mut Canvas, cells: &[CutCell], scale: &ColourScale, side: Rgb) {
        let mut ink = vec![0.0f64; self.width * self.height];
        for cell in cells {
            let pixels = self.pixels(cell);
            if cell.triangles > 0 {
                self.fill(canvas, pixels.clone(), scale.colour(cell.triangles as f64));
            }
            self.outline(&mut ink, pixels);
        }
        for (i, &strength) in ink.iter().enumerate().filter(|(_, s)| **s > 0.0) {
            canvas.blend((i % self.width) as i64, (i / self.width) as i64, side, strength);
        }
    }

    /// The first and last columns and rows of a cell; neighbours share the pixels of their common side. Sides beyond the
    /// picture are just beyond it.
    fn pixels(&self, cell: &CutCell) -> [RangeInclusive<i64>; 2] {
        let (a, b) = (self.place([cell.low[0], cell.high[1]]), self.place([cell.high[0], cell.low[1]]));
        let clamped = |x: f64, end: usize| x.round().clamp(-1.0, end as f64) as i64;
        [(0, self.width), (1, self.height)].map(|(i, end)| clamped(a[i], end)..=clamped(b[i], end))
    }

    fn fill(&self, canvas: &mut Canvas, [columns, rows]: [RangeInclusive<i64>; 2], colour: Rgb) {
        for y in rows {
            for x in columns.clone() {
                canvas.blend(x, y, colour, 1.0);
            }
        }
    }

    fn outline(&self, ink: &mut [f64], [columns, rows]: [RangeInclusive<i64>; 2]) {
        let smaller = (columns.end() - columns.start()).min(rows.end() - rows.start());
        let strength = (smaller as f64 / 8.0).clamp(0.15, 0.75);
        let mut mark = |x: i64, y: i64| {
            if (0..self.width as i64).contains(&x) && (0..self.height as i64).contains(&y) {
                let pixel = &mut ink[y as usize * self.width + x as usize];
                *pixel = pixel.max(strength);
            }
        };
        for x in columns.clone() {
            mark(x, *rows.start());
            mark(x, *rows.end());
        }
        for y in rows {
            mark(*columns.start(), y);
            mark(*columns.end(), y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_fills_the_room_and_keeps_its_shape() {
        let bounds = Aabb { min: [0.0, -1.0, 5.0], max: [9.0, 3.0, 6.0] };
        let chart = Chart::new(&bounds, 0, Size { width: 412, height: 412 });
        assert_eq!((chart.width, chart.height), (412, 112));
        assert_eq!(chart.place([-1.0, 6.0]), [BORDER, BORDER]);
        assert_eq!(chart.place([3.0, 5.0]), [406.0, 106.0]);
    }

    #[test]
    fn cells_beyond_the_picture_are_cut_off() {
        let bounds = Aabb { min: [0.0; 3], max: [1.0; 3] };
        let chart = Chart::new(&bounds, 2, Size { width: 20, height: 20 });
        let all = CutCell { low: [-1e9; 2], high: [1e9; 2], triangles: 9 };
        assert_eq!(chart.pixels(&all), [-1..=20, -1..=20]);
        let mut canvas = Canvas::new(20, 20, Rgb(1, 2, 3));
        chart.paint_cells(&mut canvas, &[all], &ColourScale::pale(9.0), Rgb(1, 2, 3));
        assert!(canvas.pixels().iter().all(|p| *p == canvas.pixels()[0] && *p != Rgb(1, 2, 3)));
    }
}
