//! Runs of consecutive triangles that lie close together: what the upper tree is made of, many times fewer than triangles.
//!
//! Meshes come object by object and strip by strip, so that neighbours in the list are mostly neighbours in space. Where they are not,
//! a run is halved until it holds together, down to single triangles: then the upper tree is what it would be without runs.

use rayon::prelude::*;

use crate::bvh::Extent;
use crate::error::Result;
use crate::geom::{Aabb, Scale, TriId};
use crate::mem::{joined, reserve};
use crate::mesh::Mesh;
use crate::options::Watch;

/// At most so many triangles are a run.
pub(super) const LONGEST: usize = 16;

/// A run's box may have so many times the area of its triangles' boxes together.
const SPREAD: f64 = 2.0;

/// Triangles that one thread looks at; a multiple of [`LONGEST`].
const CHUNK: usize = 1 << 15;

/// Boxes of runs in the space of a structure: first triangle and number of triangles; and the box of them all, as it is in the mesh.
/// Runs without a triangle that can be hit are left out. O(n).
pub(super) fn runs(mesh: &Mesh, parallel: bool, watch: &Watch<'_>) -> Result<(Vec<Extent>, Aabb)> {
    let chunk = |first: usize| {
        watch.check_cancelled()?;
        let mut found = Vec::new();
        for first in (first..(first + CHUNK).min(mesh.len())).step_by(LONGEST) {
            find(mesh, first, &mut found)?;
        }
        watch.report(CHUNK.min(mesh.len() - first));
        Ok(found)
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

/// Adds the runs among the [`LONGEST`] triangles from `first` on.
fn find(mesh: &Mesh, first: usize, found: &mut Vec<Extent>) -> Result<()> {
    let mut boxes = [Aabb::EMPTY; LONGEST];
    let n = LONGEST.min(mesh.len() - first);
    for (i, bounds) in boxes[..n].iter_mut().enumerate() {
        let [a, b, c] = mesh.triangles()[first + i];
        // No ray hits the others.
        if a != b && b != c && a != c {
            *bounds = Aabb::around(&mesh.corners(TriId((first + i) as u32)));
        }
    }
    halve(&boxes[..n], first, found)
}

/// One run, if it holds together, else those of both halves.
fn halve(boxes: &[Aabb], first: usize, found: &mut Vec<Extent>) -> Result<()> {
    let all = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
    if all.is_empty() {
        return Ok(());
    }
    let parts: f64 = boxes.iter().filter(|b| !b.is_empty()).map(half_area).sum();
    if boxes.len() == 1 || half_area(&all) <= SPREAD * parts {
        reserve(found, 1, "runs of triangles")?;
        found.push(Extent::new(&all, first as u32, boxes.len() as u32));
        return Ok(());
    }
    let (low, high) = boxes.split_at(boxes.len() / 2);
    halve(low, first, found)?;
    halve(high, first + low.len(), found)
}

/// In f64, in which no coordinates over- or underflow.
fn half_area(bounds: &Aabb) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|a| f64::from(bounds.max[a]) - f64::from(bounds.min[a]));
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
