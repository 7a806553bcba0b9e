//! Many rays from the eye: 64 at a time walk the cells together.
//!
//! ```text
//! a tile of 64 rays to one side, in eight octets
//! for each leaf that the tile's box meets:
//!     for each triangle in it, nearest first, until it is less near than what all rays have met:
//!         for each octet whose box it meets: compare its forms with the eight rays             (Kernels::see)
//! then, once a ray: THE triangle test of the one triangle that it surely hits first            (Kernels::meet_own)
//!     or of those few of which the margins don't tell which it hits first
//! ```
//! A ray with more of these than there is room for walks alone (`trace.rs`), as do those of tiles that are too wide. A tile that costs more
//! than it may is given up, and its rays are the other structure's.

use super::EyeTree;
use super::effort::{Budget, Effort};
use super::face::Face;
use super::walk::{Leaves, WalkSlots};
use crate::geom::{GeomId, Hit, InstId, Ray, RayFrame, TriId, Vec3, larger, smaller};
use crate::simd::{Aims, Job, Kernels, Met, Octet, RAYS, Views, step_of};
use crate::tile::Windows;

/// Octets of a tile.
const OCTETS: usize = 8;
/// Rays of a tile.
pub(super) const TILE: usize = OCTETS * RAYS;

/// All rays of a batch; where it comes in rows, blocks of eight rays of eight rows walk together.
pub(super) struct Closest<'a> {
    pub(super) tree: &'a EyeTree,
    pub(super) rays: &'a [Ray],
    /// How many rays a row has, if they come in rows.
    pub(super) width: Option<usize>,
    pub(super) budget: Budget,
    pub(super) hits: &'a mut [Option<Hit>],
}

impl Job for Closest<'_> {
    /// What it took.
    type Output = Effort;

    /// One loop, so that everything is compiled once.
    #[inline(always)]
    fn run<K: Kernels>(self) -> Effort {
        let (mut tile, mut windows) = (Tile::new(self.budget), Windows::new(self.rays.len(), self.width));
        loop {
            let choice = windows.next();
            if choice.rays().is_empty() {
                return tile.effort;
            }
            closest::<K>(self.tree, self.rays, choice.rays(), self.hits, &mut tile);
        }
    }
}

/// Rays to one side.
struct Tile {
    aims: [Aims; OCTETS],
    octets: [Octet; OCTETS],
    views: Views,
    /// Which of the batch's rays each is.
    order: [u32; TILE],
    /// How many there are; the rest of the last octet repeats the last one.
    len: usize,
    low: [f32; 2],
    high: [f32; 2],
    effort: Effort,
    budget: Budget,
}

const NO_AIMS: Aims = Aims {
    shear: [[0.0; RAYS]; 2],
    direction_z: [1.0; RAYS],
    t_min: [0.0; RAYS],
    t_max: [0.0; RAYS],
    side: [Aims::STRAY; RAYS],
};

impl Tile {
    fn new(budget: Budget) -> Self {
        Self {
            aims: [NO_AIMS; OCTETS],
            octets: [Octet::NEW; OCTETS],
            views: Views::NONE,
            order: [0; TILE],
            len: 0,
            low: [0.0; 2],
            high: [0.0; 2],
            effort: Effort::NONE,
            budget,
        }
    }
}

/// The hits of up to 64 of a batch's rays, by their numbers.
#[inline(always)]
fn closest<K: Kernels>(tree: &EyeTree, rays: &[Ray], which: &[u32], hits: &mut [Option<Hit>], tile: &mut Tile) {
    let octets = which.len().div_ceil(RAYS);
    for (aims, which) in tile.aims.iter_mut().zip(which.chunks(RAYS)) {
        let mut eight = [&rays[which[which.len() - 1] as usize]; RAYS];
        for (ray, &i) in eight.iter_mut().zip(which) {
            *ray = &rays[i as usize];
        }
        K::aim(&eight, &tree.eye(), aims);
    }
    let side = tile.aims[0].side[0];
    let mut others = 0;
    for aims in &tile.aims[..octets] {
        for i in 0..RAYS {
            others |= aims.side[i] ^ side;
        }
    }
    if others == 0 && side != Aims::STRAY {
        tile.len = which.len();
        tile.order[..which.len()].copy_from_slice(which);
        return one_side::<K>(tree, side, rays, hits, tile);
    }
    let all = tile.aims;
    for side in 0..=Aims::STRAY {
        gather(&all, which, side, tile);
        if tile.len > 0 && side != Aims::STRAY {
            one_side::<K>(tree, side, rays, hits, tile);
        } else {
            alone(tree, rays, hits, tile);
        }
    }
}

/// The rays of one side, side by side.
fn gather(all: &[Aims; OCTETS], which: &[u32], side: u32, tile: &mut Tile) {
    tile.len = 0;
    for (i, &ray) in which.iter().enumerate() {
        let (aims, lane) = (&all[i / RAYS], i % RAYS);
        if aims.side[lane] == side {
            put(tile, tile.len, aims, lane);
            tile.order[tile.len] = ray;
            tile.len += 1;
        }
    }
    if tile.len > 0 {
        let (last, lane) = (tile.aims[(tile.len - 1) / RAYS], (tile.len - 1) % RAYS);
        for i in tile.len..tile.len.next_multiple_of(RAYS) {
            put(tile, i, &last, lane);
        }
    }
}

fn put(tile: &mut Tile, i: usize, aims: &Aims, lane: usize) {
    let (to, at) = (&mut tile.aims[i / RAYS], i % RAYS);
    (to.shear[0][at], to.shear[1][at]) = (aims.shear[0][lane], aims.shear[1][lane]);
    (to.direction_z[at], to.t_min[at], to.t_max[at]) = (aims.direction_z[lane], aims.t_min[lane], aims.t_max[lane]);
}

/// Rays that walk alone.
#[inline(never)]
fn alone(tree: &EyeTree, rays: &[Ray], hits: &mut [Option<Hit>], tile: &mut Tile) {
    tile.effort.alone(tile.len);
    for &i in &tile.order[..tile.len] {
        hits[i as usize] = tree.closest(&rays[i as usize]);
    }
}

/// Rays that are left to the other structure.
#[inline(never)]
fn given_up(tree: &EyeTree, rays: &[Ray], hits: &mut [Option<Hit>], tile: &mut Tile) {
    tile.effort.alone(tile.len);
    for &i in &tile.order[..tile.len] {
        hits[i as usize] = tree.world.closest(&rays[i as usize]);
    }
}

/// The hits of rays to one side.
#[inline(always)]
fn one_side<K: Kernels>(tree: &EyeTree, side: u32, rays: &[Ray], hits: &mut [Option<Hit>], tile: &mut Tile) {
    let Some(face) = &tree.faces[side as usize] else { return alone(tree, rays, hits, tile) };
    frame(tile);
    if !face.takes(tile.low, tile.high) || !tree.drops_hidden() {
        return alone(tree, rays, hits, tile);
    }
    if !walk::<K>(face, tile) {
        return given_up(tree, rays, hits, tile);
    }
    let eye = face.side.along(&tree.eye());
    let (aims, octets) = (&tile.aims, &tile.octets);
    let mut met = Met { t: [0.0; RAYS], u: [0.0; RAYS], v: [0.0; RAYS], hits: 0 };
    let mut left = 0;
    for (i, order) in tile.order[..tile.len].chunks(RAYS).enumerate() {
        left += finish::<K>(tree, face, (&aims[i], &octets[i]), &eye, order, (rays, hits), &mut met);
    }
    tile.effort.alone(left);
}

/// The boxes of a tile and its octets.
#[inline(always)]
fn frame(tile: &mut Tile) {
    let octets = tile.len.div_ceil(RAYS);
    tile.views = Views::NONE;
    (tile.low, tile.high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    for i in 0..octets {
        let aims = &tile.aims[i];
        tile.octets[i] = Octet { u: aims.shear[0], v: aims.shear[1], ..Octet::NEW };
        tile.views.least[i] = f32::MIN;
        for a in 0..2 {
            let (low, high) = ends(&aims.shear[a]);
            tile.views.low[a][i] = step_of(low);
            tile.views.high[a][i] = step_of(high);
            tile.low[a] = smaller(low, tile.low[a]);
            tile.high[a] = larger(high, tile.high[a]);
        }
    }
}

/// The smallest and the largest of eight numbers.
#[inline(always)]
pub(super) fn ends(x: &[f32; RAYS]) -> (f32, f32) {
    // By halves, as vectors do it.
    let (mut low, mut high) = (*x, *x);
    for half in [4, 2, 1] {
        for i in 0..half {
            low[i] = smaller(low[i], low[i + half]);
            high[i] = larger(high[i], high[i + half]);
        }
    }
    (low[0], high[0])
}

/// Compares a tile's rays with all triangles that may be the first for any of them; not with all of them if that is beyond the budget.
#[inline(always)]
fn walk<K: Kernels>(face: &Face, tile: &mut Tile) -> bool {
    let limit = tile.effort.limit(tile.len, tile.budget);
    tile.effort.rays(tile.len);
    let mut slots = WalkSlots::new();
    let mut leaves = Leaves::new(face, tile.low, tile.high, &mut slots);
    let mut least = f32::NEG_INFINITY;
    while let Some(entries) = leaves.next() {
        for entry in entries {
            if entry.near < least {
                break;
            }
            let mut seen = K::in_view(entry, &tile.views);
            tile.effort.look(seen.count_ones());
            if tile.effort > limit {
                return false;
            }
            let mut changed = false;
            while seen != 0 {
                let i = seen.trailing_zeros() as usize & (OCTETS - 1);
                seen &= seen - 1;
                let octet = &mut tile.octets[i];
                if K::see(&face.sights[entry.sight as usize], entry.sight, octet) {
                    tile.views.least[i] = ends(&octet.least).0;
                    tile.effort.keep();
                    changed = true;
                }
            }
            if changed {
                least = ends(&tile.views.least).0;
            }
        }
    }
    true
}

/// The hits of an octet; how many rays had to walk alone.
#[inline(always)]
fn finish<K: Kernels>(
    tree: &EyeTree,
    face: &Face,
    (aims, octet): (&Aims, &Octet),
    eye: &Vec3,
    order: &[u32],
    (rays, hits): (&[Ray], &mut [Option<Hit>]),
    met: &mut Met,
) -> usize {
    let Some(any) = face.corners.first() else {
        order.iter().for_each(|&i| hits[i as usize] = None);
        return 0;
    };
    let (mut first, mut left) = (First::NONE, 0);
    let rows = if octet.several & !octet.unsure == 0 { 1 } else { Octet::CANDIDATES };
    for best in &octet.best[..rows] {
        let (mut corners, mut ids, mut there) = ([any; RAYS], [0; RAYS], 0);
        for (lane, &best) in best.iter().enumerate() {
            if let Some(found) = face.corners.get(best as usize) {
                (corners[lane], ids[lane]) = (found, found[0][3].to_bits());
                there |= 1 << lane;
            }
        }
        if there == 0 {
            break;
        }
        K::meet_own(aims, eye, &corners, met);
        first.take(met, &ids, there);
    }
    for (lane, &i) in order.iter().enumerate() {
        let (bit, ray, hit) = (1 << lane, &rays[i as usize], &mut hits[i as usize]);
        // Each is written where it belongs at once: to be put together elsewhere and copied would take a quarter of the time.
        if octet.unsure & bit != 0 {
            *hit = unsure(tree, face, ray);
            left += 1;
        } else if first.hits & bit != 0 && (first.passed & bit == 0 || aims.t_min[lane] == 0.0) {
            let (t, u, v, tri) = (first.t[lane], first.u[lane], first.v[lane], TriId(first.ids[lane]));
            *hit = Some(Hit { t, u, v, tri, geometry: GeomId(0), instance: InstId(0) });
        } else if first.passed & bit != 0 {
            *hit = beyond(tree, ray);
            left += 1;
        } else {
            *hit = None;
        }
    }
    left
}

/// The nearest hits of eight rays among a few triangles each.
struct First {
    t: [f32; RAYS],
    u: [f32; RAYS],
    v: [f32; RAYS],
    ids: [u32; RAYS],
    /// Which rays have one: a bit a lane.
    hits: u32,
    /// Which rays don't hit all of theirs.
    passed: u32,
}

impl First {
    const NONE: Self = Self { t: [0.0; RAYS], u: [0.0; RAYS], v: [0.0; RAYS], ids: [0; RAYS], hits: 0, passed: 0 };

    /// Takes what is nearer, or as near with a smaller id, of the lanes that are `there`.
    #[inline(always)]
    fn take(&mut self, met: &Met, ids: &[u32; RAYS], there: u32) {
        let hits = met.hits & there;
        self.passed |= there & !hits;
        for (i, &id) in ids.iter().enumerate() {
            let wins = met.t[i] < self.t[i] || (met.t[i] == self.t[i] && id < self.ids[i]);
            let takes = hits >> i & 1 == 1 && (self.hits >> i & 1 == 0 || wins);
            self.t[i] = if takes { met.t[i] } else { self.t[i] };
            self.u[i] = if takes { met.u[i] } else { self.u[i] };
            self.v[i] = if takes { met.v[i] } else { self.v[i] };
            self.ids[i] = if takes { id } else { self.ids[i] };
        }
        self.hits |= hits;
    }
}

/// A ray with more triangles than a few that it may hit first.
#[inline(never)]
fn unsure(tree: &EyeTree, face: &Face, ray: &Ray) -> Option<Hit> {
    tree.closest_in(face, &RayFrame::new(ray), ray, &mut ())
}

/// A ray that does not hit within its interval what it may hit first, or may hit what is hidden since it starts behind some of that.
#[cold]
#[inline(never)]
fn beyond(tree: &EyeTree, ray: &Ray) -> Option<Hit> {
    // If it ends before that, it hits nothing; if it starts behind that, what it hits may be hidden.
    if ray.t_min > 0.0 || ray.t_max == f32::INFINITY { tree.world.closest(ray) } else { None }
}
