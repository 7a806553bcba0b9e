//! From the plane of a slice to pixels.

use rdh::Aabb;

use super::Plane;
use super::section::CutCell;
use crate::args::Size;
use crate::picture::{Canvas, ColourScale, Rect, Rgb};

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
            let rect = self.rect(cell);
            if cell.triangles > 0 {
                canvas.fill(rect, scale.colour(cell.triangles as f64));
            }
            let strength = (rect.width.min(rect.height) as f64 / 8.0).clamp(0.15, 0.75);
            self.outline(&mut ink, rect, strength);
        }
        for (i, &strength) in ink.iter().enumerate().filter(|(_, s)| **s > 0.0) {
            canvas.blend((i % self.width) as i64, (i / self.width) as i64, side, strength);
        }
    }

    /// The pixels from the cell's lower sides to its upper ones; neighbours share the pixels of their common side.
    fn rect(&self, cell: &CutCell) -> Rect {
        let (a, b) = (self.place([cell.low[0], cell.high[1]]), self.place([cell.high[0], cell.low[1]]));
        let [x, y] = a.map(|x| x.round() as usize);
        let [right, bottom] = b.map(|x| x.round() as usize);
        Rect { x, y, width: right - x + 1, height: bottom - y + 1 }
    }

    fn outline(&self, ink: &mut [f64], rect: Rect, strength: f64) {
        let mut mark = |x: usize, y: usize| {
            if x < self.width && y < self.height {
                let pixel = &mut ink[y * self.width + x];
                *pixel = pixel.max(strength);
            }
        };
        for x in rect.x..rect.x + rect.width {
            mark(x, rect.y);
            mark(x, rect.y + rect.height - 1);
        }
        for y in rect.y..rect.y + rect.height {
            mark(rect.x, y);
            mark(rect.x + rect.width - 1, y);
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
}
