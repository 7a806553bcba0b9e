//! From a mesh to the trees of six sides.

use rayon::prelude::*;

use super::EyeTree;
use super::cell::Cell;
use super::face::{Face, Layout};
use super::grow::{Grower, Reference, Todo};
use super::rays::{Place, Places};
use super::side::Side;
use super::spec::{EyeForm, EyeOptions};
use super::viewer::Viewer;
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::geom::{RayFrame, Vec3};
use crate::mem::{joined, reserve};
use crate::options::{BuildOptions, Watch};
use crate::rays::Training;
use crate::simd::{Passing, Sight};

/// The distance between neighbouring rays where nothing is known of them: 1024 across a side.
const PIXEL: f32 = 2.0 / 1024.0;
/// Rays across a bundle.
const BUNDLE: f32 = 8.0;
/// References a tree may have, for each triangle that its side sees.
const REFERENCES: usize = 6;
/// Triangles that one thread projects.
const CHUNK: usize = 1 << 13;

impl EyeTree {
    /// Builds the trees around `eye` over the mesh of `world`, which answers all rays that have nothing to do with the eye:
    /// O(N log N). Without training rays the trees know all directions and are cut by areas; with some, only the window of each side
    /// in which those rays lie, and they are cut by the rays too.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for the eye, with the axis of the first such coordinate; [`Error::OutOfMemory`], [`Error::OverBudget`] or
    /// [`Error::Cancelled`].
    pub fn build(
        world: Accel,
        eye: Vec3,
        rays: &Training,
        spec: &EyeOptions,
        options: &BuildOptions<'_>,
    ) -> Result<Self> {
        if let Some(axis) = eye.iter().position(|x| !x.is_finite()) {
            return Err(Error::NotFinite { vertex: 0, axis, value: eye[axis] });
        }
        let mesh = world.mesh().clone();
        let passing = Passing::new(eye, &mesh.bounds());
        // Where f32 over- or underflows, others know better.
        let usual = passing.is_usual();
        let sampled = sampled(rays, &passing, spec.form);
        let watch = Watch::new(options, mesh.len() * Side::COUNT);
        let viewer = Viewer { mesh: &mesh, form: spec.form, passing: &passing };
        let plan = Plan { viewer, spec, watch: &watch, options };
        let faces = match options.threads {
            _ if !usual => Default::default(),
            None | Some(1) => plan.faces(&sampled)?,
            Some(threads) => crate::accel::in_pool(threads, || plan.faces(&sampled))?,
        };
        let tree = Self {
            form: spec.form,
            passing,
            faces,
            masks: mesh.mask_array(),
            world,
            level: options.level(),
            trained_on: rays.len(),
        };
        match options.max_bytes {
            Some(limit) if tree.bytes() > limit => Err(Error::OverBudget { what: "bytes", limit }),
            _ => Ok(tree),
        }
    }
}

/// The places of sampled rays, side by side; of all, if there are any.
fn sampled(rays: &Training, passing: &Passing, form: EyeForm) -> Option<[Places; Side::COUNT]> {
    if rays.is_empty() {
        return None;
    }
    let mut sides: [Places; Side::COUNT] = Default::default();
    for sample in rays.samples().iter().filter(|s| s.ray.is_valid()) {
        let frame = RayFrame::new(&sample.ray);
        let side = if sample.ray.origin == passing.eye {
            Side::of(&frame)
        } else if form == EyeForm::Towards && passing.approach(&frame).is_some() {
            Side::of(&frame).opposite()
        } else {
            continue;
        };
        sides[side.index()].0.push(Place { at: frame.shear, weight: sample.weight as f32 });
    }
    Some(sides)
}

/// What all sides share.
struct Plan<'a> {
    viewer: Viewer<'a>,
    spec: &'a EyeOptions,
    watch: &'a Watch<'a>,
    options: &'a BuildOptions<'a>,
}

impl Plan<'_> {
    fn faces(&self, sampled: &Option<[Places; Side::COUNT]>) -> Result<[Option<Face>; Side::COUNT]> {
        let mut faces: [Option<Face>; Side::COUNT] = Default::default();
        for side in Side::all() {
            let none = Places::default();
            let (window, places) = match sampled {
                None => (Cell::WHOLE, &none),
                Some(sides) if sides[side.index()].0.is_empty() => continue,
                Some(sides) => (widened(sides[side.index()].window()), &sides[side.index()]),
            };
            faces[side.index()] = Some(self.face(side, window, places)?);
        }
        Ok(faces)
    }

    fn face(&self, side: Side, window: Cell, places: &Places) -> Result<Face> {
        let (sights, boxes) = self.seen(side, &window)?;
        let refs: Vec<Reference> =
            (0..sights.len() as u32).map(|index| Reference { index, near: sights[index as usize].near }).collect();
        let budget = self.options.max_refs.unwrap_or(REFERENCES * refs.len() + 1000).max(refs.len());
        let grower = Grower {
            sights: &sights,
            boxes: &boxes,
            foot: BUNDLE * self.spec.pixel.unwrap_or_else(|| pixel(&window, places)),
            drops_hidden: self.viewer.mesh.masks().is_none(),
            parallel: self.parallel(),
            watch: self.watch,
        };
        let todo = Todo { cell: window, refs, places: places.among(&window, 0.0), depth: 0, budget };
        let branch = grower.grow(todo)?;
        let foot = grower.foot;
        Layout::of((side, window, foot), &branch, &sights, &boxes, |id| self.viewer.corners(side, id))
    }

    fn parallel(&self) -> bool {
        self.options.threads != Some(1)
    }

    /// Everything that a side may see in its window.
    fn seen(&self, side: Side, window: &Cell) -> Result<(Vec<Sight>, Vec<Cell>)> {
        let chunk = |start: usize| -> Result<Vec<(Sight, Cell)>> {
            self.watch.check_cancelled()?;
            let mut seen = Vec::new();
            for id in start..(start + CHUNK).min(self.viewer.mesh.len()) {
                let Some((sight, place)) = self.viewer.look_at(side, id as u32, window) else { continue };
                reserve(&mut seen, 1, "sights")?;
                seen.push((sight, place));
            }
            Ok(seen)
        };
        let starts = (0..self.viewer.mesh.len()).step_by(CHUNK);
        let chunks: Result<Vec<_>> = if self.parallel() {
            (0..self.viewer.mesh.len()).into_par_iter().step_by(CHUNK).map(chunk).collect()
        } else {
            starts.map(chunk).collect()
        };
        let chunks = chunks?;
        let lists: Vec<&[(Sight, Cell)]> = chunks.iter().map(|c| &c[..]).collect();
        Ok(joined(&lists, self.parallel(), "sights", |_, seen| seen)?.into_iter().unzip())
    }
}

/// A window around sampled rays: others of the same kind reach a little farther.
fn widened(window: Cell) -> Cell {
    let pad = [0, 1].map(|a| 0.05 * (window.high[a] - window.low[a]) + 4.0 * PIXEL);
    Cell {
        low: [0, 1].map(|a| (window.low[a] - pad[a]).max(-1.0)),
        high: [0, 1].map(|a| (window.high[a] + pad[a]).min(1.0)),
    }
}

/// How far apart rays are, as the samples' weights say; no farther than is usual, since rows may be closer together than the rays in
/// them.
fn pixel(window: &Cell, places: &Places) -> f32 {
    let weight = places.weight();
    // Samples of weight 1 were not counted: there may have been any number of rays.
    if weight <= 2.0 * places.0.len() as f32 {
        return PIXEL;
    }
    let area = (window.high[0] - window.low[0]) * (window.high[1] - window.low[1]);
    (area / weight).sqrt().clamp(1e-5, PIXEL)
}
