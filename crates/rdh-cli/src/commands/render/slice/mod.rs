//! Slices, the paper's Figure 1: the cells that a plane cuts, the surfaces there, and the sampled rays near it.

mod chart;
mod near;
mod section;

use anyhow::Result;
use rdh::{Accel, Spec, Training};

use self::chart::Chart;
use self::near::{NearRay, rays_near};
use self::section::{CutCell, cut_cells, cut_triangles};
use super::{Built, Picture, Request};
use crate::args::{Place, Slice};
use crate::exit::usage;
use crate::picture::{
    Canvas, ColourBar, ColourScale, Item, Panel, Pen, Rgb, draw_disc, draw_figure, draw_line, round_up, short_number,
};
use crate::staged::Staged;

const CELL: Rgb = Rgb(70, 100, 140);
const SURFACE: Pen = Pen { colour: Rgb(20, 22, 26), width: 1.4, alpha: 0.9 };
const RAY: Pen = Pen { colour: Rgb(226, 88, 20), width: 0.9, alpha: 0.5 };
const END: Rgb = Rgb(180, 30, 20);
/// More rays than this hide what is below.
const MOST_RAYS: usize = 150;

/// A plane in the scene's own coordinates.
#[derive(Debug, Clone, Copy)]
struct Plane {
    axis: usize,
    position: f64,
    /// How far from the plane rays are still drawn.
    near: f64,
}

/// One structure's part of a slice.
pub(super) struct Sliced {
    pub(super) spec: Spec,
    /// How many cells are cut.
    pub(super) note: String,
    pub(super) canvas: Canvas,
}

/// Draws one panel a structure, all with the same surfaces and rays.
pub(super) fn draw(
    request: &Request,
    slice: Slice,
    staged: &Staged,
    built: &[Built],
    training: &Training,
) -> Result<Picture> {
    let (panels, scale, rays) = drawn(request, slice, staged, built, training)?;
    let panel = |s: Sliced| Item::Panel(Panel { title: s.spec.to_string(), note: s.note, picture: s.canvas });
    let mut items: Vec<Item> = panels.into_iter().map(panel).collect();
    items.push(Item::Bar(ColourBar { scale, label: "triangles".to_owned() }));
    let plane = Plane::new(slice, staged)?;
    let canvas = draw_figure(&title(request, slice, staged, &plane, rays), &items);
    Ok(Picture { canvas, channels: Vec::new(), channel_width: 0 })
}

/// A slice through each structure, with a line about it.
pub(super) fn panels(
    request: &Request,
    slice: Slice,
    staged: &Staged,
    built: &[Built],
    training: &Training,
) -> Result<Vec<Sliced>> {
    Ok(drawn(request, slice, staged, built, training)?.0)
}

/// The slices, the scale of their cells, and how many rays are in each.
fn drawn(
    request: &Request,
    slice: Slice,
    staged: &Staged,
    built: &[Built],
    training: &Training,
) -> Result<(Vec<Sliced>, ColourScale, usize)> {
    let plane = Plane::new(slice, staged)?;
    let part = request.part_of(staged, plane.axis);
    let chart = Chart::new(&part, plane.axis, request.size);
    let rays = rays_near(training.samples(), &plane, &part, MOST_RAYS);
    let cells: Vec<_> = built.iter().map(|b| cut_cells(&b.accel, &plane)).collect();
    let scale = ColourScale::pale(common_end(&cells));
    let panel = |(b, cells): (&Built, &Vec<CutCell>)| Sliced {
        spec: b.spec,
        note: note(cells, &b.accel),
        canvas: draw_panel(staged, &plane, &chart, cells, &rays, &scale),
    };
    Ok((built.iter().zip(&cells).map(panel).collect(), scale, rays.len()))
}

impl Plane {
    fn new(slice: Slice, staged: &Staged) -> Result<Self> {
        let (axis, bounds, origin) = (slice.axis.index(), staged.stage.bounds(), staged.stage.origin());
        if bounds.is_empty() {
            return Err(usage("the scene has no triangle to slice"));
        }
        let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
        let position = match slice.place {
            Place::World(x) => x - origin[axis],
            Place::Part(part) => low + part * (high - low),
            Place::Eye => staged.view.eye[axis] - origin[axis],
        };
        if !(low..=high).contains(&position) {
            let [position, low, high] = [position, low, high].map(|x| short_number(x + origin[axis]));
            return Err(usage(format!("the plane at {position} misses the scene, which goes from {low} to {high}")));
        }
        Ok(Self { axis, position, near: 0.01 * f64::from(bounds.diagonal()) })
    }

    /// The two axes that span it: to the right, and up.
    fn axes(axis: usize) -> [usize; 2] {
        [[1, 2], [0, 2], [0, 1]][axis]
    }
}

fn draw_panel(
    staged: &Staged,
    plane: &Plane,
    chart: &Chart,
    cells: &[CutCell],
    rays: &[NearRay],
    scale: &ColourScale,
) -> Canvas {
    let mut canvas = Canvas::new(chart.width, chart.height, Rgb(255, 255, 255));
    chart.paint_cells(&mut canvas, cells, scale, CELL);
    for [from, to] in cut_triangles(staged.stage.mesh(), plane) {
        draw_line(&mut canvas, chart.place(from), chart.place(to), SURFACE);
    }
    for ray in rays {
        draw_line(&mut canvas, chart.place(ray.from), chart.place(ray.to), RAY);
    }
    for end in rays.iter().filter(|r| r.hit_near).map(|r| chart.place(r.to)) {
        draw_disc(&mut canvas, end, 1.5, END);
    }
    canvas
}

fn note(cells: &[CutCell], accel: &Accel) -> String {
    format!("{} of {} cells cut", cells.len(), accel.stats().leaves)
}

/// A round number of triangles that all but one in 100 of the cells hold at most.
fn common_end(cells: &[Vec<CutCell>]) -> f64 {
    let mut counts: Vec<_> = cells.iter().flatten().map(|c| c.triangles).collect();
    counts.sort_unstable();
    round_up(counts.get(counts.len() * 99 / 100).copied().unwrap_or(1).max(1) as f64)
}

fn title(request: &Request, slice: Slice, staged: &Staged, plane: &Plane, rays: usize) -> String {
    let name = ["x", "y", "z"][slice.axis.index()];
    let position = short_number(plane.position + staged.stage.origin()[plane.axis]);
    format!("{}  {name} = {position}, {rays} {} rays near it", staged.name(), request.mode)
}
