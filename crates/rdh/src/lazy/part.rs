//! Parting runs into the subtrees of a wide node: a few steps of the binary builder, the largest part first.

use std::ops::Range;

use super::ground::WHOLE;
use super::runs;
use crate::bvh::{Centres, Chooser, Extent, Search, SplitSearch, Todo};
use crate::error::Result;
use crate::geom::Aabb;
use crate::mem::reserve;
use crate::simd::Level;

/// Below this depth runs are halved by number alone, so that the tree ends: 2³⁰ of them within [`DEEPEST`] levels.
const HALVED_FROM: u32 = 16;

/// The deepest that nodes of the upper tree lie.
pub(super) const DEEPEST: u32 = HALVED_FROM + 11;

/// How runs are parted.
pub(super) struct Parting<'a, C> {
    /// What chooses the splits.
    pub(super) chooser: &'a C,
    pub(super) level: Level,
    /// Whether several threads look at large sets.
    pub(super) parallel: bool,
}

/// A part of the runs.
struct Part<R> {
    range: Range<usize>,
    triangles: usize,
    todo: Todo<R>,
}

/// Orders runs, of more triangles than [`WHOLE`], so that up to eight parts follow each other, none empty: their boxes and ranges, the
/// largest box first. O(n log n) at worst.
pub(super) fn split_into_eight<C: Chooser>(
    all: &mut [Extent],
    depth: u32,
    parting: &Parting<'_, C>,
    rays: C::Rays,
) -> Result<Vec<(Aabb, Range<usize>)>> {
    let search =
        Search { level: parting.level, parallel: parting.parallel, split: SplitSearch::Binned, bins: 32, leaf: 1 };
    let (extent, centres) = search.measure(all);
    let mut parts = Vec::new();
    reserve(&mut parts, 8, "nodes")?;
    parts.push(Part {
        range: 0..all.len(),
        triangles: runs::count(all),
        todo: Todo { extent, centres, depth: 0, rays },
    });
    while parts.len() < 8 {
        let Some(which) = dearest(&parts, depth) else { break };
        let part = parts.swap_remove(which);
        parts.extend(halve(all, &part, depth, &search, parting.chooser));
    }
    parts.sort_by(|a, b| {
        b.todo.extent.half_area().total_cmp(&a.todo.extent.half_area()).then(a.range.start.cmp(&b.range.start))
    });
    Ok(parts.into_iter().map(|part| (part.todo.extent.bounds(), part.range)).collect())
}

/// Of the parts that are not to grow in whole that which costs rays most; deep down the one with the most triangles.
fn dearest<R>(parts: &[Part<R>], depth: u32) -> Option<usize> {
    let cost = |part: &Part<R>| {
        let area = if depth < HALVED_FROM { part.todo.extent.half_area() } else { 1.0 };
        area * part.triangles as f32
    };
    let open = (0..parts.len()).filter(|&i| parts[i].triangles > WHOLE);
    open.max_by(|&a, &b| cost(&parts[a]).total_cmp(&cost(&parts[b])).then(b.cmp(&a)))
}

/// Two parts of one.
fn halve<C: Chooser>(
    all: &mut [Extent],
    part: &Part<C::Rays>,
    depth: u32,
    search: &Search,
    chooser: &C,
) -> [Part<C::Rays>; 2] {
    let runs = &mut all[part.range.clone()];
    let split = if depth < HALVED_FROM { chooser.best(search, runs, &part.todo, None) } else { None };
    let (left, sides): (usize, [(Extent, Centres); 2]) = match split {
        Some(split) => {
            let (left, [low, high]) = search.part(runs, &split);
            (left, [(split.left, low), (split.right, high)])
        }
        None => {
            let left = runs.len() / 2;
            (left, [search.measure(&runs[..left]), search.measure(&runs[left..])])
        }
    };
    let (low, high) = runs.split_at(left);
    let middle = part.range.start + left;
    let side = |range: Range<usize>, runs: &[Extent], (extent, centres): (Extent, Centres)| Part {
        range,
        triangles: runs::count(runs),
        todo: Todo { extent, centres, depth: 0, rays: chooser.descend(&part.todo.rays, &extent) },
    };
    let [l, r] = sides;
    [side(part.range.start..middle, low, l), side(middle..part.range.end, high, r)]
}
