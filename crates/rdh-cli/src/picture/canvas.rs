//! A canvas of sRGB pixels with what our figures need: boxes, lines and text.

use super::font;

/// An opaque colour, 8-bit sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rgb(pub u8, pub u8, pub u8);

impl From<colorous::Color> for Rgb {
    fn from(c: colorous::Color) -> Self {
        Self(c.r, c.g, c.b)
    }
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rect {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

/// Pixels, row by row from the top. Whatever is drawn beyond its sides is cut off.
#[derive(Debug, Clone)]
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

impl Canvas {
    /// A canvas of one colour.
    pub(crate) fn new(width: usize, height: usize, colour: Rgb) -> Self {
        Self { width, height, pixels: vec![colour; width * height] }
    }

    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row from the top.
    pub(crate) fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// Lays a colour over a pixel; `alpha` 1 covers it.
    pub(crate) fn blend(&mut self, x: i64, y: i64, colour: Rgb, alpha: f64) {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return;
        }
        let below = &mut self.pixels[y as usize * self.width + x as usize];
        let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * alpha.clamp(0.0, 1.0)).round() as u8;
        *below = Rgb(mix(below.0, colour.0), mix(below.1, colour.1), mix(below.2, colour.2));
    }

    /// Fills a rectangle.
    pub(crate) fn fill(&mut self, rect: Rect, colour: Rgb) {
        for y in rect.y..rect.y + rect.height {
            for x in rect.x..rect.x + rect.width {
                self.blend(x as i64, y as i64, colour, 1.0);
            }
        }
    }

    /// Draws a line of one pixel just around a rectangle.
    pub(crate) fn frame(&mut self, rect: Rect, colour: Rgb) {
        let (left, top) = (rect.x as i64 - 1, rect.y as i64 - 1);
        let (right, bottom) = ((rect.x + rect.width) as i64, (rect.y + rect.height) as i64);
        for x in left..=right {
            self.blend(x, top, colour, 1.0);
            self.blend(x, bottom, colour, 1.0);
        }
        for y in top + 1..bottom {
            self.blend(left, y, colour, 1.0);
            self.blend(right, y, colour, 1.0);
        }
    }

    /// Writes text with its upper left corner at (x, y), every dot `scale` pixels wide.
    pub(crate) fn text(&mut self, (x, y): (usize, usize), text: &str, scale: usize, colour: Rgb) {
        for (i, c) in text.chars().enumerate() {
            for (column, row) in font::dots(c) {
                let (x, y) = (x + (i * font::ADVANCE + column) * scale, y + row * scale);
                self.fill(Rect { x, y, width: scale, height: scale }, colour);
            }
        }
    }

    /// Copies pixels of another canvas, each `zoom` pixels wide, to (x, y).
    pub(crate) fn paste(&mut self, (x, y): (usize, usize), other: &Self, zoom: usize) {
        for row in 0..other.height {
            for column in 0..other.width {
                let rect = Rect { x: x + column * zoom, y: y + row * zoom, width: zoom, height: zoom };
                self.fill(rect, other.pixels[row * other.width + column]);
            }
        }
    }
}

/// How wide and high a line of text is in pixels, tails of letters not counted.
pub(crate) fn text_size(text: &str, scale: usize) -> (usize, usize) {
    (font::width(text) * scale, font::HEIGHT * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Rgb = Rgb(0, 0, 0);
    const WHITE: Rgb = Rgb(255, 255, 255);

    #[test]
    fn drawing_beyond_the_sides_is_cut_off() {
        let mut canvas = Canvas::new(3, 2, WHITE);
        canvas.fill(Rect { x: 2, y: 1, width: 9, height: 9 }, BLACK);
        canvas.text((0, 100), "far below", 3, BLACK);
        assert_eq!(canvas.pixels().iter().filter(|p| **p == BLACK).count(), 1);
        assert_eq!(canvas.pixels()[5], BLACK);
    }

    #[test]
    fn half_a_cover_is_half_way() {
        let mut canvas = Canvas::new(1, 1, WHITE);
        canvas.blend(0, 0, BLACK, 0.5);
        assert_eq!(canvas.pixels(), [Rgb(128, 128, 128)]);
    }

    #[test]
    fn a_zoomed_copy_repeats_each_pixel() {
        let mut small = Canvas::new(2, 1, WHITE);
        small.fill(Rect { x: 1, y: 0, width: 1, height: 1 }, BLACK);
        let mut large = Canvas::new(4, 2, WHITE);
        large.paste((0, 0), &small, 2);
        assert_eq!(large.pixels(), [WHITE, WHITE, BLACK, BLACK, WHITE, WHITE, BLACK, BLACK]);
    }
}
