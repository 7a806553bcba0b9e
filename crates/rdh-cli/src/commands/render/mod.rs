//! `rdh render`: pictures.

mod heat;
mod shade;
mod slice;
mod thumbs;

use std::path::Path;

use anyhow::Result;
use rdh::{Aabb, Accel, Spec, Training};
use rdh_study::{Mode, Plan};
use serde_json::json;

use crate::args::{Heat, RenderArgs, Size, Slice};
use crate::context::Context;
use crate::exit::usage;
use crate::output::{print, print_json, write_file};
use crate::pick::Shelf;
use crate::picture::{Canvas, Channel, exr_bytes, png_bytes};
use crate::staged::Staged;

pub(crate) use thumbs::{Thumbnail, thumbnails};

/// What is to be drawn, and from what.
#[derive(Debug)]
struct Request {
    subject: Subject,
    specs: Vec<Spec>,
    mode: Mode,
    size: Size,
    plan: Plan,
    zoom: f32,
    format: Format,
}

#[derive(Debug, Clone, Copy)]
enum Subject {
    Shaded,
    Heat(Heat),
    Slice(Slice),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
}

/// A structure and what it is called.
#[derive(Debug)]
struct Built {
    spec: Spec,
    accel: Accel,
}

/// A finished picture: what eyes see, and the numbers behind it.
#[derive(Debug)]
struct Picture {
    canvas: Canvas,
    /// Row by row from the top, all of one size.
    channels: Vec<Channel>,
    channel_width: usize,
}

/// Loads the scene, builds what is asked for, draws, and writes the file.
pub(crate) fn run(args: &RenderArgs, context: &Context) -> Result<()> {
    let request = Request::new(args, context.seed)?;
    let target = Shelf::open(context.folder.as_deref())?.find_view(&args.scene, args.view.as_deref())?;
    let bar = context.bar(request.specs.len() as u64 + 2);
    bar.set_message("reading");
    let staged = Staged::load(&target)?;
    bar.inc(1);
    let training = request.training(&staged)?;
    let mut built = Vec::new();
    for &spec in &request.specs {
        bar.set_message(format!("building {spec}"));
        built.push(Built { spec, accel: staged.build(&spec, &training)? });
        bar.inc(1);
    }
    bar.set_message("drawing");
    let picture = request.draw(&staged, &built, &training)?;
    bar.finish_and_clear();
    let bytes = match request.format {
        Format::Png => png_bytes(&picture.canvas)?,
        Format::Exr => exr_bytes(picture.channel_width, picture.channels)?,
    };
    write_file(&args.output, &bytes)?;
    report(args, &staged, &picture.canvas, context)
}

impl Request {
    fn new(args: &RenderArgs, seed: u64) -> Result<Self> {
        let subject = match (args.heat, args.slice) {
            (Some(heat), _) => Subject::Heat(heat),
            (None, Some(slice)) => Subject::Slice(slice),
            (None, None) => Subject::Shaded,
        };
        let usual = if matches!(subject, Subject::Shaded) { "kd+sah" } else { "kd+sah,kd+rdh" };
        let specs = Spec::list(args.spec.as_deref().unwrap_or(usual)).map_err(|e| usage(e.to_string()))?;
        let format = format(&args.output)?;
        match subject {
            Subject::Shaded if specs.len() > 1 => {
                return Err(usage("a shaded picture looks the same by all specs: give one"));
            }
            Subject::Heat(Heat::Diff) if specs.len() < 2 => return Err(usage("--heat diff needs two specs at least")),
            Subject::Slice(_) if format == Format::Exr => return Err(usage("a slice is a drawing: write it as .png")),
            _ => {}
        }
        let size = args.size;
        let plan = Plan { size: [size.width, size.height], training: args.training, seed, ..Plan::default() };
        Ok(Self { subject, specs, mode: args.mode, size, plan, zoom: args.zoom, format })
    }

    /// The view's training rays, if anything here needs them: they are cast through a plain tree.
    fn training(&self, staged: &Staged) -> Result<Training> {
        if !self.specs.iter().any(Spec::needs_rays) && !matches!(self.subject, Subject::Slice(_)) {
            return Ok(Training::none());
        }
        let first = staged.build(&Spec::default(), &Training::none())?;
        Ok(staged.shoot(self.mode, &self.plan).training(&first, self.size.width * self.size.height))
    }

    /// What a slice shows of the scene's box: all of it, or the part around the view's target whose longest side is so many
    /// times shorter; across the slice all of it.
    fn part_of(&self, staged: &Staged, across: usize) -> Aabb {
        let (bounds, origin, target) = (staged.stage.bounds(), staged.stage.origin(), staged.view.target);
        let longest = bounds.extent().into_iter().fold(0.0, f32::max);
        let side = |a: usize| {
            if a == across {
                return [bounds.min[a], bounds.max[a]];
            }
            let half = 0.5 * bounds.extent()[a].min(longest / self.zoom);
            let middle = ((target[a] - origin[a]) as f32).min(bounds.max[a] - half).max(bounds.min[a] + half);
            [middle - half, middle + half]
        };
        let sides = [0, 1, 2].map(side);
        Aabb { min: sides.map(|s| s[0]), max: sides.map(|s| s[1]) }
    }

    fn draw(&self, staged: &Staged, built: &[Built], training: &Training) -> Result<Picture> {
        match self.subject {
            Subject::Shaded => Ok(shade::draw(self, staged, &built[0].accel)),
            Subject::Heat(heat) => Ok(heat::draw(self, heat, staged, built)),
            Subject::Slice(slice) => slice::draw(self, slice, staged, built, training),
        }
    }
}

fn format(file: &Path) -> Result<Format> {
    let extension = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(Format::Png),
        Some("exr") => Ok(Format::Exr),
        _ => Err(usage(format!("'{}' should end in .png or .exr", file.display()))),
    }
}

fn report(args: &RenderArgs, staged: &Staged, canvas: &Canvas, context: &Context) -> Result<()> {
    let (file, size) = (args.output.display().to_string(), [canvas.width(), canvas.height()]);
    if context.json {
        let (scene, view) = (&staged.scene, &staged.view.name);
        return print_json(&json!({ "version": 1, "file": file, "scene": scene, "view": view, "size": size }));
    }
    print(&format!("{file}: {}, {} x {} pixels\n", staged.name(), size[0], size[1]))
}
