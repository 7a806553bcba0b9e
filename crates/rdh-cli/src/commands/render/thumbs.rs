//! Small pictures of one view for a report: the view, slices, steps and tests, without titles of their own.

use anyhow::Result;
use rdh::{Axis, Spec, TriId};
use rdh_study::{Mode, Plan};

use super::heat::{Map, common_end, differences, map};
use super::slice::Sliced;
use super::{Built, Format, Request, Subject, shade, slice};
use crate::args::{Heat, Place, Size, Slice};
use crate::picture::{Canvas, ColourScale, Rgb};
use crate::staged::Staged;

/// A picture, and what is to be said of it.
#[derive(Debug)]
pub(crate) struct Thumbnail {
    pub title: String,
    pub note: String,
    /// For those who can't see it.
    pub says: String,
    pub canvas: Canvas,
    /// What its colours mean: values, and what they count.
    pub scale: Option<(ColourScale, String)>,
}

const SIDE: usize = 224;
/// Enough to know where most of them are.
const SAMPLED_TRIANGLES: usize = 20_000;
/// Pictures of few colours are small files, and no eye tells more shades apart.
const SHADES: f64 = 40.0;

/// The view with a slice by each spec; the steps by each spec and their difference; the same of the tests.
pub(crate) fn thumbnails(staged: &Staged, specs: &[Spec], seed: u64) -> Result<Vec<Vec<Thumbnail>>> {
    let request = request(specs, seed);
    let training = request.training(staged)?;
    let built: Vec<Built> =
        specs.iter().map(|&spec| Ok(Built { spec, accel: staged.build(&spec, &training)? })).collect::<Result<_>>()?;
    let plane = Slice { axis: upright_axis(staged), place: Place::Part(0.5) };
    let mut first = vec![view(&request, staged, &built[0])];
    let request = Request { zoom: zoom(staged), ..request };
    let panels = slice::panels(&request, plane, staged, &built, &training)?;
    first.extend(panels.into_iter().map(|s| sliced(staged, s)));
    Ok(vec![first, heats(&request, Heat::Steps, staged, &built), heats(&request, Heat::Tests, staged, &built)])
}

fn request(specs: &[Spec], seed: u64) -> Request {
    let plan = Plan { size: [SIDE, SIDE], seed, ..Plan::default() };
    let size = Size { width: SIDE, height: SIDE };
    Request {
        subject: Subject::Shaded,
        specs: specs.to_vec(),
        mode: Mode::Primary,
        size,
        plan,
        zoom: 1.0,
        format: Format::Png,
    }
}

/// Slices are cut across the axis along which the scene is thinnest: a building shows its plan.
fn upright_axis(staged: &Staged) -> Axis {
    let extent = staged.stage.bounds().extent();
    let thinner = |a: &Axis, b: &Axis| extent[a.index()].total_cmp(&extent[b.index()]);
    [Axis::X, Axis::Y, Axis::Z].into_iter().min_by(thinner).unwrap_or(Axis::Z)
}

/// How much a slice is magnified, so that a wide ground around a scene doesn't make it a dot: by how much the box of the scene
/// is larger than that of nine tenths of its triangles, with some room around them.
fn zoom(staged: &Staged) -> f32 {
    let (mesh, extent) = (staged.stage.mesh(), staged.stage.bounds().extent());
    let step = (mesh.len() / SAMPLED_TRIANGLES).max(1);
    let middle = |axis: usize| {
        let mut places: Vec<f32> =
            (0..mesh.len()).step_by(step).map(|i| mesh.corners(TriId(i as u32))[0][axis]).collect();
        places.sort_unstable_by(f32::total_cmp);
        let at = |part: usize| places.get(places.len() * part / 100).copied().unwrap_or(0.0);
        at(95) - at(5)
    };
    let (longest, inner) =
        (extent.into_iter().fold(0.0, f32::max), [0, 1, 2].map(middle).into_iter().fold(0.0, f32::max));
    if inner > 0.0 { (longest / (1.5 * inner)).clamp(1.0, 16.0) } else { 1.0 }
}

fn view(request: &Request, staged: &Staged, built: &Built) -> Thumbnail {
    let canvas = shade::draw(request, staged, &built.accel).canvas;
    let says = format!("The view {}", staged.name());
    Thumbnail { title: "The view".into(), note: String::new(), says, canvas, scale: None }
}

fn sliced(staged: &Staged, slice: Sliced) -> Thumbnail {
    let Sliced { spec, note, canvas } = slice;
    let says = format!("A slice through {} with the cells of {spec} and the sampled rays near it", staged.scene);
    Thumbnail { title: format!("slice, {spec}"), note, says, canvas, scale: None }
}

fn heats(request: &Request, heat: Heat, staged: &Staged, built: &[Built]) -> Vec<Thumbnail> {
    let maps: Vec<Map> = built.iter().map(|b| map(request, heat, staged, b)).collect();
    let differences = differences(&maps);
    let counted = if heat == Heat::Tests { "tests" } else { "steps" };
    let (sequential, diverging) =
        (ColourScale::sequential(common_end(&maps)), ColourScale::diverging(common_end(&differences)));
    let of = |map: &Map, scale: ColourScale| heat_map(map, scale, counted, &staged.name());
    maps.iter().map(|m| of(m, sequential)).chain(differences.iter().map(|m| of(m, diverging))).collect()
}

fn heat_map(map: &Map, scale: ColourScale, counted: &str, place: &str) -> Thumbnail {
    let mut canvas = Canvas::new(SIDE, map.values.len() / SIDE, Rgb(0, 0, 0));
    for (i, &value) in map.values.iter().enumerate() {
        let shade = (scale.position(value) * SHADES).round() / SHADES;
        let colour = scale.colour(scale.low + shade * (scale.high - scale.low));
        canvas.blend((i % SIDE) as i64, (i / SIDE) as i64, colour, 1.0);
    }
    let mean = map.values.iter().sum::<f64>() / map.values.len().max(1) as f64;
    let name = map.name.replace(" - ", " − ");
    let says = format!("{counted} a pixel of {place} by {name}, on average {mean:.1}");
    let note = format!("mean {mean:.1}").replace('-', "−");
    Thumbnail { title: format!("{counted}, {name}"), note, says, canvas, scale: Some((scale, counted.to_owned())) }
}
