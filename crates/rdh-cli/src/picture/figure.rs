//! Figures: panels side by side with titles, and colour bars with numbers.

use super::canvas::{Canvas, Rect, Rgb, text_size};
use super::scale::ColourScale;
use super::short_number;

/// One picture of a figure, with two lines above it.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub title: String,
    pub note: String,
    pub picture: Canvas,
}

/// What the colours of the panels to its left mean.
#[derive(Debug, Clone)]
pub(crate) struct ColourBar {
    pub scale: ColourScale,
    pub label: String,
}

/// What stands in a figure, from left to right.
#[derive(Debug, Clone)]
pub(crate) enum Item {
    Panel(Panel),
    Bar(ColourBar),
}

const PAPER: Rgb = Rgb(255, 255, 255);
const INK: Rgb = Rgb(32, 36, 42);
const GREY: Rgb = Rgb(110, 116, 124);
const RULE: Rgb = Rgb(190, 195, 200);

const MARGIN: usize = 24;
const GAP: usize = 20;
const LINE: usize = 24;
const TEXT: usize = 2;
/// Panels smaller than this are enlarged by whole pixels, so that their titles find room.
const SMALLEST_PANEL: usize = 320;
const BAR_WIDTH: usize = 20;
const MOST_TICKS: usize = 7;
/// Pixels of a bar's height that a number needs.
const TICK_ROOM: usize = 40;

/// Draws a figure: its title, then the items in a row.
pub(crate) fn draw_figure(title: &str, items: &[Item]) -> Canvas {
    let (top, panel_height) = (MARGIN + 2 * LINE + LINE + 4, items.iter().map(height).max().unwrap_or(0));
    let row: usize = items.iter().map(width).sum::<usize>() + GAP * items.len().saturating_sub(1);
    let width_all = row.max(text_size(title, TEXT).0) + 2 * MARGIN;
    let mut canvas = Canvas::new(width_all, top + panel_height + MARGIN, PAPER);
    canvas.text((MARGIN, MARGIN), title, TEXT, INK);
    let mut x = MARGIN;
    for item in items {
        match item {
            Item::Panel(panel) => draw_panel(&mut canvas, panel, (x, top)),
            Item::Bar(bar) => draw_bar(&mut canvas, bar, Rect { x, y: top, width: BAR_WIDTH, height: panel_height }),
        }
        x += width(item) + GAP;
    }
    canvas
}

fn draw_panel(canvas: &mut Canvas, panel: &Panel, (x, y): (usize, usize)) {
    let zoom = zoom(panel);
    let room = panel.picture.width() * zoom;
    fitted_text(canvas, (x, y - 2 * LINE), room, &panel.title, INK);
    fitted_text(canvas, (x, y - LINE), room, &panel.note, GREY);
    canvas.paste((x, y), &panel.picture, zoom);
    canvas.frame(Rect { x, y, width: room, height: panel.picture.height() * zoom }, RULE);
}

fn draw_bar(canvas: &mut Canvas, bar: &ColourBar, rect: Rect) {
    // A little above the panels' notes: the topmost number reaches over the bar's end.
    canvas.text((rect.x, rect.y - LINE - 8), &bar.label, TEXT, GREY);
    let span = (rect.height - 1).max(1) as f64;
    for row in 0..rect.height {
        let share = 1.0 - row as f64 / span;
        let value = bar.scale.low + share * (bar.scale.high - bar.scale.low);
        canvas.fill(Rect { y: rect.y + row, height: 1, ..rect }, bar.scale.colour(value));
    }
    canvas.frame(rect, RULE);
    for tick in bar.scale.ticks((rect.height / TICK_ROOM).clamp(1, MOST_TICKS)) {
        let y = rect.y + ((1.0 - bar.scale.position(tick)) * span).round() as usize;
        canvas.fill(Rect { x: rect.x + rect.width, y, width: 6, height: 1 }, INK);
        let high = text_size("0", TEXT).1;
        canvas.text((rect.x + rect.width + 10, y.saturating_sub(high / 2)), &short_number(tick), TEXT, INK);
    }
}

/// Text at the usual size, at half of it where it would be too wide, cut where even that is.
fn fitted_text(canvas: &mut Canvas, at: (usize, usize), room: usize, text: &str, colour: Rgb) {
    if text_size(text, TEXT).0 <= room {
        return canvas.text(at, text, TEXT, colour);
    }
    let mut short = text.to_owned();
    while text_size(&short, 1).0 > room {
        short.pop();
    }
    canvas.text((at.0, at.1 + 4), &short, 1, colour);
}

fn zoom(panel: &Panel) -> usize {
    SMALLEST_PANEL.div_ceil(panel.picture.width().max(1))
}

fn width(item: &Item) -> usize {
    match item {
        Item::Panel(panel) => panel.picture.width() * zoom(panel),
        Item::Bar(bar) => {
            let numbers =
                bar.scale.ticks(MOST_TICKS).iter().map(|t| text_size(&short_number(*t), TEXT).0).max().unwrap_or(0);
            (BAR_WIDTH + 10 + numbers).max(text_size(&bar.label, TEXT).0)
        }
    }
}

fn height(item: &Item) -> usize {
    match item {
        Item::Panel(panel) => panel.picture.height() * zoom(panel),
        Item::Bar(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(width: usize, height: usize) -> Item {
        let picture = Canvas::new(width, height, Rgb(9, 9, 9));
        Item::Panel(Panel { title: "kd+sah".into(), note: "mean 12".into(), picture })
    }

    #[test]
    fn small_panels_are_enlarged_by_whole_pixels() {
        let figure = draw_figure("t", &[panel(32, 16)]);
        assert_eq!(figure.width(), 320 + 2 * MARGIN);
        assert_eq!(figure.pixels().iter().filter(|p| **p == Rgb(9, 9, 9)).count(), 320 * 160);
    }

    #[test]
    fn everything_fits_on_the_canvas() {
        let bar = ColourBar { scale: ColourScale::sequential(123_456.0), label: "steps per ray".into() };
        let figure = draw_figure("scene", &[panel(400, 300), panel(400, 300), Item::Bar(bar)]);
        let border = |x: usize, y: usize| x < 8 || y < 8 || x >= figure.width() - 8 || y >= figure.height() - 8;
        for (i, pixel) in figure.pixels().iter().enumerate() {
            assert!(!border(i % figure.width(), i / figure.width()) || *pixel == PAPER, "pixel {i}");
        }
    }

    #[test]
    fn titles_that_are_too_long_are_cut() {
        let mut canvas = Canvas::new(40, 30, PAPER);
        fitted_text(&mut canvas, (0, 0), 20, "much too long for this", INK);
        let beyond = canvas.pixels().iter().enumerate().filter(|(i, p)| i % 40 >= 20 && **p != PAPER);
        assert_eq!(beyond.count(), 0);
    }
}
