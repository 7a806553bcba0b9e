//! Pictures of the views that are worth one.

use anyhow::Result;
use rdh::Spec;
use rdh_study::report::{Panel, Picture, Scale, Shown, views_to_show};
use rdh_study::study::Merged;

use crate::commands::render::{Thumbnail, thumbnails};
use crate::context::Context;
use crate::pick::Shelf;
use crate::picture::{ColourScale, small_png_bytes};
use crate::staged::Staged;

/// What is compared in pictures.
const SPECS: &str = "kd+sah,kd+rdh";
/// Colours of a scale beside a picture.
const COLOURS: usize = 9;

/// Draws them. A scene that isn't there (of a folder that isn't given, say) has none; that is said.
pub(super) fn draw(merged: &Merged, shelf: &Shelf, context: &Context) -> Vec<Picture> {
    let shown = views_to_show(&merged.records);
    let bar = context.bar(shown.len() as u64);
    let mut pictures = Vec::new();
    for shown in &shown {
        let place = format!("{}:{}", shown.scene, shown.view);
        bar.set_message(place.clone());
        match draw_view(shelf, &place, shown, merged.plan.seed) {
            Ok(picture) => pictures.push(picture),
            Err(error) => tracing::warn!("no picture of {place}: {error:#}"),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    pictures
}

fn draw_view(shelf: &Shelf, place: &str, shown: &Shown, seed: u64) -> Result<Picture> {
    let staged = Staged::load(&shelf.find_view(&shown.scene, Some(&shown.view))?)?;
    let rows = thumbnails(&staged, &Spec::list(SPECS)?, seed)?;
    let rows = rows.into_iter().map(|row| row.into_iter().map(panel).collect()).collect::<Result<_>>()?;
    Ok(Picture { place: place.to_owned(), why: shown.why.clone(), rows })
}

fn panel(thumbnail: Thumbnail) -> Result<Panel> {
    let Thumbnail { title, note, says, canvas, scale } = thumbnail;
    let size = [canvas.width(), canvas.height()];
    let scale = scale.map(|(scale, label)| colours(&scale, label));
    Ok(Panel { title, note, says, png: small_png_bytes(&canvas)?, size, scale })
}

fn colours(scale: &ColourScale, label: String) -> Scale {
    let value = |i: usize| scale.low + (scale.high - scale.low) * i as f64 / (COLOURS - 1) as f64;
    let colour = |i: usize| {
        let rgb = scale.colour(value(i));
        [rgb.0, rgb.1, rgb.2]
    };
    Scale { label, ends: [scale.low, scale.high], colours: (0..COLOURS).map(colour).collect() }
}
