//! Runs of consecutive triangles that lie close together: what the upper tree is made of, many times fewer than triangles.
//!
//! Meshes come object by object and strip by strip, so that neighbours in the list are mostly neighbours in space. Where they are not,
//! a run is halved until it holds together, down to single triangles: then the upper tree is what it would be without runs.

use std::ops::Range;

use rayon::prelude::*;

use crate::bvh::Extent;
use crate::error::Result;
use crate::geom::{Aabb, Scale, TriId, Vec3};
use crate::mem::{joined, reserve};
use crate::mesh::Mesh;
use crate::options::Watch;
use crate::simd::{Job, Kernels, Level, Portable};

/// At most so many triangles are a run.
pub(super) const LONGEST: usize = 16;

/// A run's box may have so many times the area of its triangles' boxes together.
const SPREAD: f64 = 2.0;

/// Triangles that one thread looks at; a multiple of [`LONGEST`].
const CHUNK: usize = 1 << 15;

/// Boxes of runs in the space of a structure: first triangle and number of triangles; and the box of them all, as it is in the mesh.
/// Runs without a triangle that can be hit are left out. O(n).
pub(super) fn runs(mesh: &Mesh, level: Level, parallel: bool, watch: &Watch<'_>) -> Result<(Vec<Extent>, Aabb)> {
    let chunk = |first: usize| {
        watch.check_cancelled()?;
        let ids = first..(first + CHUNK).min(mesh.len());
        watch.report(ids.len());
        level.run(Find { mesh, ids })
    };
    let starts = (0..mesh.len()).step_by(CHUNK);
    let chunks: Result<Vec<Vec<Extent>>> = if parallel {
        starts.collect::<Vec<_>>().into_par_iter().map(chunk).collect()
    } else {
        starts.map(chunk).collect()
    };
    let chunks = chunks?;
    let slices: Vec<&[Extent]> = chunks.iter().map(|chunk| &chunk[..]).collect();
    let bounds = slices.iter().copied().flatten().fold(Aabb::EMPTY, |all, run| all.union(&run.bounds()));
    let factor = Scale::of(&bounds).factor();
    let runs = joined(&slices, parallel, "runs of triangles", |_, run: Extent| scaled(run, factor))?;
    Ok((runs, bounds))
}

fn scaled(run: Extent, factor: f32) -> Extent {
    Extent { min: run.min.map(|x| x * factor), negated_max: run.negated_max.map(|x| x * factor), ..run }
}

/// Finds the runs among some triangles.
struct Find<'a> {
    mesh: &'a Mesh,
    ids: Range<usize>,
}

impl Job for Find<'_> {
    type Output = Result<Vec<Extent>>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Self::Output {
        let Self { mesh, ids } = self;
        let mut found = Vec::new();
        let mut boxes = [Extent::EMPTY; LONGEST];
        let mut first = ids.start;
        while first < ids.end {
            let n = LONGEST.min(ids.end - first);
            let (mut all, mut parts) = (Extent::EMPTY, 0.0);
            for (bounds, triangle) in boxes.iter_mut().zip(&mesh.triangles()[first..first + n]) {
                *bounds = Extent::EMPTY;
                let [a, b, c] = *triangle;
                // No ray hits the others.
                if a != b && b != c && a != c {
                    for vertex in [a, b, c] {
                        bounds.grow::<K>(&point(mesh.positions()[vertex as usize]));
                    }
                    all.grow::<K>(bounds);
                    parts += half_area(bounds);
                }
            }
            if half_area(&all) <= SPREAD * parts {
                add(&all, first, n, &mut found)?;
            } else {
                halve(&boxes[..n], first, &mut found)?;
            }
            first += n;
        }
        Ok(found)
    }
}

/// One run, if it holds together, else those of both halves.
fn halve(boxes: &[Extent], first: usize, found: &mut Vec<Extent>) -> Result<()> {
    let mut all = Extent::EMPTY;
    boxes.iter().for_each(|b| all.grow::<Portable>(b));
    let parts: f64 = boxes.iter().filter(|b| !b.is_empty()).map(half_area).sum();
    if boxes.len() == 1 || all.is_empty() || half_area(&all) <= SPREAD * parts {
        return add(&all, first, boxes.len(), found);
    }
    let (low, high) = boxes.split_at(boxes.len() / 2);
    halve(low, first, found)?;
    halve(high, first + low.len(), found)
}

fn add(bounds: &Extent, first: usize, n: usize, found: &mut Vec<Extent>) -> Result<()> {
    if !bounds.is_empty() {
        reserve(found, 1, "runs of triangles")?;
        found.push(bounds.with(first as u32, n as u32));
    }
    Ok(())
}

/// A box around a point. Zeros lose their sign, as in [`Extent::new`].
#[inline(always)]
fn point(p: Vec3) -> Extent {
    Extent { min: p.map(|x| x + 0.0), link: 0, negated_max: p.map(|x| 0.0 - x), count: 0 }
}

/// In f64, in which no coordinates over- or underflow. That of an empty box means nothing.
#[inline(always)]
fn half_area(bounds: &Extent) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|a| -f64::from(bounds.negated_max[a]) - f64::from(bounds.min[a]));
    x * y + y * z + z * x
}

/// A run's triangles, those that no ray hits left out.
pub(super) fn triangles(mesh: &Mesh, run: Extent) -> impl Iterator<Item = TriId> + '_ {
    let first = run.link as usize;
    mesh.solid_among(first..first + run.count as usize)
}

/// How many triangles some runs have, the unhittable ones included.
pub(super) fn count(runs: &[Extent]) -> usize {
    runs.iter().map(|run| run.count as usize).sum()
}
