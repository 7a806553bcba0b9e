//! Pictures: a canvas, lines, a tiny font, colour scales, figures with legends, and the two file formats.

mod canvas;
mod encode;
mod figure;
mod font;
mod line;
mod scale;

pub(crate) use canvas::{Canvas, Rgb};
pub(crate) use encode::{Channel, exr_bytes, png_bytes, small_png_bytes};
pub(crate) use figure::{ColourBar, Item, Panel, draw_figure};
pub(crate) use line::{Pen, draw_disc, draw_line};
pub(crate) use rdh_study::report::short_number;
pub(crate) use scale::{ColourScale, round_up};
