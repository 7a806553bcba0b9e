//! Pictures as bytes: PNG for eyes, EXR for numbers.

use std::collections::BTreeMap;
use std::io::Cursor;

use anyhow::{Context, Result};
use exr::prelude::*;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::canvas::{Canvas, Rgb};

/// One channel of an EXR file.
#[derive(Debug, Clone)]
pub(crate) struct Channel {
    pub name: String,
    /// Row by row from the top.
    pub values: Vec<f32>,
}

/// A canvas as PNG.
pub(crate) fn png_bytes(canvas: &Canvas) -> Result<Vec<u8>> {
    let pixels: Vec<u8> = canvas.pixels().iter().flat_map(|p| [p.0, p.1, p.2]).collect();
    let (width, height) = (canvas.width() as u32, canvas.height() as u32);
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(&pixels, width, height, ExtendedColorType::Rgb8).context("PNG")?;
    Ok(bytes)
}

/// A canvas as PNG with a palette: colours that eyes hardly tell apart become one until 256 are left.
pub(crate) fn small_png_bytes(canvas: &Canvas) -> Result<Vec<u8>> {
    let (palette, indices) = (0..8).find_map(|bits| with_palette(canvas, bits)).context("PNG: too many colours")?;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, canvas.width() as u32, canvas.height() as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(palette.iter().flat_map(|p| [p.0, p.1, p.2]).collect::<Vec<u8>>());
    encoder.write_header().and_then(|mut w| w.write_image_data(&indices)).context("PNG")?;
    Ok(bytes)
}

/// The colours and which of them each pixel has, if they are few enough when so many low bits don't count.
fn with_palette(canvas: &Canvas, bits: u32) -> Option<(Vec<Rgb>, Vec<u8>)> {
    let mut numbers: BTreeMap<[u8; 3], u8> = BTreeMap::new();
    let mut palette = Vec::new();
    let mut indices = Vec::with_capacity(canvas.pixels().len());
    for pixel in canvas.pixels() {
        let key = [pixel.0 >> bits, pixel.1 >> bits, pixel.2 >> bits];
        let next = u8::try_from(palette.len());
        let index = match numbers.get(&key) {
            Some(&index) => index,
            None => {
                palette.push(*pixel);
                *numbers.entry(key).or_insert(next.ok()?)
            }
        };
        indices.push(index);
    }
    Some((palette, indices))
}

/// Channels of linear numbers as EXR, 32 bits each.
pub(crate) fn exr_bytes(width: usize, channels: Vec<Channel>) -> Result<Vec<u8>> {
    let height = channels.first().map_or(0, |c| c.values.len()) / width.max(1);
    let list = channels.iter().map(|c| AnyChannel::new(c.name.as_str(), FlatSamples::F32(c.values.clone()))).collect();
    let layer =
        Layer::new((width, height), LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(list));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).context("EXR")?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_comes_back_as_it_was() {
        let mut canvas = Canvas::new(5, 3, Rgb(250, 128, 3));
        canvas.blend(2, 1, Rgb(0, 0, 0), 1.0);
        let read = image::load_from_memory(&png_bytes(&canvas).unwrap()).unwrap().to_rgb8();
        assert_eq!(read.dimensions(), (5, 3));
        let expected: Vec<u8> = canvas.pixels().iter().flat_map(|p| [p.0, p.1, p.2]).collect();
        assert_eq!(read.into_raw(), expected);
    }

    #[test]
    fn a_small_png_keeps_few_colours_and_joins_many() {
        let mut canvas = Canvas::new(40, 30, Rgb(250, 128, 3));
        canvas.blend(2, 1, Rgb(0, 0, 0), 1.0);
        let read = |canvas: &Canvas| image::load_from_memory(&small_png_bytes(canvas).unwrap()).unwrap().to_rgb8();
        let expected: Vec<u8> = canvas.pixels().iter().flat_map(|p| [p.0, p.1, p.2]).collect();
        assert_eq!(read(&canvas).into_raw(), expected);
        for (x, y) in (0..40).flat_map(|x| (0..30).map(move |y| (x, y))) {
            canvas.blend(x, y, Rgb(6 * x as u8, 8 * y as u8, (x * y / 5) as u8), 1.0);
        }
        let far = |(a, b): (&image::Rgb<u8>, &Rgb)| {
            [a[0].abs_diff(b.0), a[1].abs_diff(b.1), a[2].abs_diff(b.2)].into_iter().max()
        };
        assert!(read(&canvas).pixels().zip(canvas.pixels()).map(far).all(|d| d <= Some(32)));
    }

    #[test]
    fn an_exr_keeps_every_number() {
        let values: Vec<f32> = (0..6).map(|i| i as f32 * 1000.25).collect();
        let channel = Channel { name: "kd+sah.steps".into(), values: values.clone() };
        let bytes = exr_bytes(3, vec![channel]).unwrap();
        let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = image.all_attributes().from_buffered(Cursor::new(bytes)).unwrap();
        let back = &image.layer_data.channel_data.list[0];
        assert_eq!(back.name.to_string(), "kd+sah.steps");
        assert_eq!(back.sample_data.values_as_f32().collect::<Vec<_>>(), values);
    }
}
