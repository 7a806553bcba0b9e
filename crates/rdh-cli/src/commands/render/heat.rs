//! Heat maps: what each pixel's rays cost, on one scale for all structures.

use rayon::prelude::*;
use rdh::{Accel, Counts};
use rdh_study::{Lens, path_counts};

use super::shade::film_position;
use super::{Built, Picture, Request};
use crate::args::Heat;
use crate::picture::{Canvas, Channel, ColourBar, ColourScale, Item, Panel, Rgb, draw_figure, round_up, short_number};
use crate::staged::Staged;

/// The costs of a picture's pixels by one structure.
pub(super) struct Map {
    pub(super) name: String,
    /// Row by row from the top.
    pub(super) values: Vec<f64>,
}

/// Draws the maps side by side, and with [`Heat::Diff`] the differences to the first.
pub(super) fn draw(request: &Request, heat: Heat, staged: &Staged, built: &[Built]) -> Picture {
    let maps: Vec<Map> = built.iter().map(|b| map(request, heat, staged, b)).collect();
    let differences = if heat == Heat::Diff { differences(&maps) } else { Vec::new() };
    let width = request.size.width;
    let mut items = group(&maps, width, ColourScale::sequential(common_end(&maps)), unit(heat));
    if !differences.is_empty() {
        let scale = ColourScale::diverging(common_end(&differences));
        items.extend(group(&differences, width, scale, "difference"));
    }
    let canvas = draw_figure(&title(request, staged, heat), &items);
    let channels = maps.iter().chain(&differences).map(|m| channel(m, heat)).collect();
    Picture { canvas, channels, channel_width: width }
}

pub(super) fn map(request: &Request, heat: Heat, staged: &Staged, built: &Built) -> Map {
    let counts = pixel_counts(request, staged, &built.accel);
    let value = |c: &Counts| if heat == Heat::Tests { c.tests } else { c.steps() } as f64;
    Map { name: built.spec.to_string(), values: counts.iter().map(value).collect() }
}

/// What the path through each pixel's centre costs.
fn pixel_counts(request: &Request, staged: &Staged, accel: &Accel) -> Vec<Counts> {
    let (width, height) = (request.size.width, request.size.height);
    let lens = Lens::new(&staged.stage, request.mode, &staged.view, width as f64 / height as f64);
    let counts = |index: usize| {
        let [x, y] = film_position(index, width, height, [0.5, 0.5], request.mode);
        path_counts(&staged.stage, accel, request.mode, &lens.ray(x, y), request.plan.seed, index as u64)
    };
    (0..width * height).into_par_iter().map(counts).collect()
}

/// What every map but the first differs from it.
pub(super) fn differences(maps: &[Map]) -> Vec<Map> {
    let [base, others @ ..] = maps else { return Vec::new() };
    let difference = |m: &Map| Map {
        name: format!("{} - {}", m.name, base.name),
        values: m.values.iter().zip(&base.values).map(|(a, b)| a - b).collect(),
    };
    others.iter().map(difference).collect()
}

fn group(maps: &[Map], width: usize, scale: ColourScale, label: &str) -> Vec<Item> {
    let panels = maps.iter().map(|m| Item::Panel(panel(m, width, &scale)));
    panels.chain([Item::Bar(ColourBar { scale, label: label.to_owned() })]).collect()
}

fn panel(map: &Map, width: usize, scale: &ColourScale) -> Panel {
    let mut picture = Canvas::new(width, map.values.len() / width, Rgb(0, 0, 0));
    for (i, &value) in map.values.iter().enumerate() {
        picture.blend((i % width) as i64, (i / width) as i64, scale.colour(value), 1.0);
    }
    let mean = map.values.iter().sum::<f64>() / map.values.len().max(1) as f64;
    let (least, most) = map.values.iter().fold((0.0f64, 0.0f64), |(a, b), &x| (a.min(x), b.max(x)));
    let range = if least < 0.0 {
        format!("{} to {}", short_number(least), short_number(most))
    } else {
        format!("max {}", short_number(most))
    };
    Panel { title: map.name.clone(), note: format!("mean {mean:.1}, {range}"), picture }
}

/// A round number that all but one in 200 of the values reach at most: a few extreme pixels would hide all others.
pub(super) fn common_end(maps: &[Map]) -> f64 {
    let mut sizes: Vec<f64> = maps.iter().flat_map(|m| &m.values).map(|x| x.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    round_up(sizes.get(sizes.len() * 199 / 200).copied().unwrap_or(1.0).max(1.0))
}

fn channel(map: &Map, heat: Heat) -> Channel {
    Channel { name: format!("{}.{}", map.name, unit(heat)), values: map.values.iter().map(|&x| x as f32).collect() }
}

fn unit(heat: Heat) -> &'static str {
    match heat {
        Heat::Steps | Heat::Diff => "steps",
        Heat::Tests => "tests",
    }
}

fn title(request: &Request, staged: &Staged, heat: Heat) -> String {
    let what = if heat == Heat::Tests { "triangles tested" } else { "nodes visited" };
    format!("{}  {what} a pixel, {} rays", staged.name(), request.mode)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: &[f64]) -> Map {
        Map { name: "m".into(), values: values.to_vec() }
    }

    #[test]
    fn one_extreme_pixel_does_not_set_the_scale() {
        let mut values = vec![10.0; 999];
        values.push(1e6);
        assert_eq!(common_end(&[map(&values)]), 10.0);
        assert_eq!(common_end(&[map(&[0.0])]), 1.0);
    }

    #[test]
    fn differences_are_to_the_first_map() {
        let found = differences(&[map(&[5.0, 5.0]), map(&[3.0, 6.0])]);
        assert_eq!((found.len(), found[0].values.as_slice()), (1, [-2.0, 1.0].as_slice()));
    }
}
