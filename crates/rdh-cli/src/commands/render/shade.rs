//! Shaded pictures.

use rayon::prelude::*;
use rdh::Accel;
use rdh_study::{Lens, Mode, radiance};

use super::{Picture, Request};
use crate::picture::{Canvas, Channel, Rgb};
use crate::staged::Staged;

/// Samples of a pixel along each side; modes with random numbers need more for a quiet picture.
const SAMPLES: usize = 2;

/// Draws what the view sees, by the mode's paths.
pub(super) fn draw(request: &Request, staged: &Staged, accel: &Accel) -> Picture {
    let (width, height) = (request.size.width, request.size.height);
    let aspect = width as f64 / height as f64;
    let lens = Lens::new(&staged.stage, request.mode, &staged.view, aspect);
    let pixel = |index: usize| {
        let light = |sample: usize| {
            let offset = [sample % SAMPLES, sample / SAMPLES].map(|s| (s as f64 + 0.5) / SAMPLES as f64);
            let [x, y] = film_position(index, width, height, offset, request.mode);
            let number = (index * SAMPLES * SAMPLES + sample) as u64;
            radiance(&staged.stage, accel, request.mode, &lens.ray(x, y), request.plan.seed, number)
        };
        (0..SAMPLES * SAMPLES).map(light).sum::<f32>() / (SAMPLES * SAMPLES) as f32
    };
    let values: Vec<f32> = (0..width * height).into_par_iter().map(pixel).collect();
    let mut canvas = Canvas::new(width, height, Rgb(0, 0, 0));
    for (i, value) in values.iter().enumerate() {
        canvas.blend((i % width) as i64, (i / width) as i64, grey(*value), 1.0);
    }
    let channel = |name: &str| Channel { name: name.to_owned(), values: values.clone() };
    Picture { canvas, channels: ["R", "G", "B"].map(channel).into(), channel_width: width }
}

/// Where on the film a point of a pixel is. A scanner's film has its beams across and its turn downwards, beginning where
/// the view looks; pictures have the beams downwards, and the view's direction in the middle.
pub(super) fn film_position(index: usize, width: usize, height: usize, offset: [f64; 2], mode: Mode) -> [f64; 2] {
    let x = ((index % width) as f64 + offset[0]) / width as f64;
    let y = ((index / width) as f64 + offset[1]) / height as f64;
    if mode == Mode::Lidar { [y, (x + 0.5).fract()] } else { [x, y] }
}

/// Linear light as sRGB.
fn grey(light: f32) -> Rgb {
    let light = f64::from(light).clamp(0.0, 1.0);
    let coded = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    let level = (255.0 * coded).round() as u8;
    Rgb(level, level, level)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_ends_at_black_and_white_and_half_the_light_looks_brighter_than_half() {
        assert_eq!([grey(-1.0), grey(2.0), grey(0.5)], [Rgb(0, 0, 0), Rgb(255, 255, 255), Rgb(188, 188, 188)]);
    }

    #[test]
    fn the_middle_of_the_last_pixel() {
        assert_eq!(film_position(7, 4, 2, [0.5, 0.5], Mode::Primary), [0.875, 0.75]);
        assert_eq!(film_position(7, 4, 2, [0.5, 0.5], Mode::Lidar), [0.75, 0.375]);
    }
}
