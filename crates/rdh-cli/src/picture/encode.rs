//! Pictures as bytes: PNG for eyes, EXR for numbers.

use std::io::Cursor;

use anyhow::{Context, Result};
use exr::prelude::*;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::canvas::Canvas;

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
    use super::super::canvas::Rgb;
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
