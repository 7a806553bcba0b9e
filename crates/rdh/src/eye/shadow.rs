//! Many rays towards the eye: as [`super::tile`], but any hit will do, and what is certain needs no test at all.

use std::ops::Range;

use super::EyeTree;
use super::effort::{Budget, Effort};
use super::face::Face;
use super::spec::EyeForm;
use super::tile::ends;
use super::walk::{Leaves, WalkSlots};
use crate::geom::{Ray, larger, smaller};
use crate::simd::{Aims, Eight, Entry, Job, Kernels, RAYS, Shade, Views, sheared, step_of};

/// Octets of a tile.
const OCTETS: usize = 8;
/// Rays of a tile.
const TILE: usize = OCTETS * RAYS;

/// All rays of a batch.
pub(super) struct Occluded<'a> {
    pub(super) tree: &'a EyeTree,
    pub(super) rays: &'a [Ray],
    pub(super) budget: Budget,
    pub(super) found: &'a mut [bool],
}

impl Job for Occluded<'_> {
    /// What it took.
    type Output = Effort;

    /// One loop, so that everything is compiled once.
    #[inline(always)]
    fn run<K: Kernels>(self) -> Effort {
        let mut tile = Tile::NEW;
        for (rays, found) in self.rays.chunks(TILE).zip(self.found.chunks_mut(TILE)) {
            let (sides, mut waiting) = tile.approach::<K>(self.tree, rays);
            let all = tile.octets;
            while waiting != 0 {
                let side = waiting.trailing_zeros();
                // Most often all come from one side, and are as they should be.
                if waiting != 1 << side || tile.count < rays.len() {
                    tile.select::<K>(&all, &sides[..rays.len()], side);
                }
                waiting &= waiting - 1;
                one_side::<K>(self.tree, (side, self.budget), rays, found, &mut tile);
            }
        }
        tile.effort
    }
}

/// Rays from one side.
struct Tile {
    /// As the rays are seen from the eye, each in its place; others are done, and lie where one of them does.
    octets: [Shade; OCTETS],
    /// Which rays they are, a bit each, and how many.
    chosen: [u8; OCTETS],
    count: usize,
    views: Views,
    /// The octets' boxes: `low[axis][octet]`.
    low: [[f32; OCTETS]; 2],
    high: [[f32; OCTETS]; 2],
    /// Rays that the other structure is asked about, a bit a lane: something lies between their end and the eye, or their octet is too
    /// wide, or was given up.
    asked: [u8; OCTETS],
    stopped: [u8; OCTETS],
    effort: Effort,
}

impl Tile {
    const NEW: Self = Self {
        octets: [Shade::DONE; OCTETS],
        chosen: [0; OCTETS],
        count: 0,
        views: Views::NONE,
        low: [[0.0; OCTETS]; 2],
        high: [[0.0; OCTETS]; 2],
        asked: [0; OCTETS],
        stopped: [0; OCTETS],
        effort: Effort::NONE,
    };

    /// Makes up to 64 rays ready as if they all came from one side. From which each comes, and from which any does: a bit a side.
    #[inline(always)]
    fn approach<K: Kernels>(&mut self, tree: &EyeTree, rays: &[Ray]) -> ([u32; TILE], u32) {
        let (mut sides, mut some) = ([Aims::STRAY; TILE], 0);
        self.chosen = [0; OCTETS];
        self.count = rays.len();
        for (i, rays) in rays.chunks(RAYS).enumerate() {
            let mut last = [rays[rays.len() - 1]; RAYS];
            let eight = rays.first_chunk().unwrap_or_else(|| {
                last[..rays.len()].copy_from_slice(rays);
                &last
            });
            let sides = &mut sides[i * RAYS..][..RAYS];
            if tree.form == EyeForm::Towards {
                sides.copy_from_slice(&K::approach(eight, &tree.passing, &mut self.octets[i]));
            }
            self.chosen[i] = (0xff >> (RAYS - rays.len())) as u8;
            self.octets[i].finish::<K::Eight>(u32::from(!self.chosen[i]));
            some = sides.iter().fold(some, |some, &side| some | 1 << side);
        }
        (sides, some)
    }

    /// Keeps the rays of one side.
    #[inline(always)]
    fn select<K: Kernels>(&mut self, all: &[Shade; OCTETS], sides: &[u32], side: u32) {
        (self.chosen, self.count) = ([0; OCTETS], 0);
        for (i, sides) in sides.chunks(RAYS).enumerate() {
            let Some(first) = sides.iter().position(|&own| own == side) else { continue };
            let shade = &mut self.octets[i];
            *shade = all[i];
            for lane in 0..RAYS {
                if sides.get(lane) == Some(&side) {
                    self.chosen[i] |= 1 << lane;
                } else {
                    (shade.u[lane], shade.v[lane]) = (shade.u[first], shade.v[first]);
                }
            }
            shade.finish::<K::Eight>(u32::from(!self.chosen[i]));
            self.count += self.chosen[i].count_ones() as usize;
        }
    }

    /// The boxes of its octets.
    #[inline(always)]
    fn frame(&mut self) {
        self.views = Views::NONE;
        (self.asked, self.stopped) = ([0; OCTETS], [0; OCTETS]);
        for (i, shade) in self.octets.iter().enumerate().filter(|&(i, _)| self.chosen[i] != 0) {
            for (a, x) in [&shade.u, &shade.v].into_iter().enumerate() {
                let (low, high) = ends(x);
                (self.low[a][i], self.high[a][i]) = (low, high);
                (self.views.low[a][i], self.views.high[a][i]) = (step_of(low), step_of(high));
            }
        }
    }

    /// Only some octets are of interest; their box.
    #[inline(always)]
    fn narrow(&mut self, octets: Range<usize>) -> ([f32; 2], [f32; 2]) {
        let (mut lows, mut highs) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        self.views.least = [f32::INFINITY; RAYS];
        for i in octets.filter(|&i| self.chosen[i] != 0) {
            for (a, (low, high)) in lows.iter_mut().zip(&mut highs).enumerate() {
                (*low, *high) = (smaller(self.low[a][i], *low), larger(self.high[a][i], *high));
            }
            self.views.least[i] = ends(&self.octets[i].far).0;
        }
        (lows, highs)
    }

    /// Some rays of an octet are stopped.
    #[inline(always)]
    fn stop<K: Kernels>(&mut self, octet: usize, stopped: u32) {
        self.stopped[octet] |= stopped as u8;
        self.octets[octet].finish::<K::Eight>(stopped);
        self.views.least[octet] = ends(&self.octets[octet].far).0;
    }
}

/// The answers of rays from one side; what is too wide walks by halves, what is too dear is given up.
#[inline(always)]
fn one_side<K: Kernels>(
    tree: &EyeTree,
    (side, budget): (u32, Budget),
    rays: &[Ray],
    found: &mut [bool],
    tile: &mut Tile,
) {
    tile.frame();
    match tree.faces.get(side as usize).and_then(Option::as_ref).filter(|_| tree.drops_hidden()) {
        None => tile.asked = tile.chosen,
        Some(face) => {
            let limit = tile.effort.limit(tile.count, budget);
            tile.effort.approach(tile.count);
            let (mut from, mut count) = (0, OCTETS);
            while from < OCTETS {
                let (low, high) = tile.narrow(from..from + count);
                let takes = face.takes(low, high);
                if !takes && count > 1 {
                    count /= 2;
                    continue;
                }
                if !takes || !walk::<K>(face, (low, high), rays, tile, limit) {
                    let octets = from..from + count;
                    tile.asked[octets.clone()].copy_from_slice(&tile.chosen[octets]);
                }
                from += count;
                // The other half, or what comes after both.
                count = 1 << from.trailing_zeros();
            }
        }
    }
    for (i, found) in found.chunks_mut(RAYS).enumerate() {
        let (chosen, stopped) = (tile.chosen[i], tile.stopped[i]);
        if chosen == 0xff {
            for (lane, found) in found.iter_mut().enumerate() {
                *found = stopped >> lane & 1 == 1;
            }
        } else {
            each(chosen, |lane| found[lane] = stopped >> lane & 1 == 1);
        }
        let open = tile.asked[i] & !stopped;
        each(open, |lane| found[lane] = tree.world.occluded(&rays[i * RAYS + lane]));
        tile.effort.alone(open.count_ones() as usize);
    }
}

/// Does something for each bit that is set.
fn each(mut bits: u8, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize & (RAYS - 1));
        bits &= bits - 1;
    }
}

/// Compares a tile's rays with all triangles that may stop any of them; not with all of them if that is beyond the limit.
#[inline(always)]
fn walk<K: Kernels>(
    face: &Face,
    (low, high): ([f32; 2], [f32; 2]),
    rays: &[Ray],
    tile: &mut Tile,
    limit: Effort,
) -> bool {
    let mut slots = WalkSlots::new();
    let mut leaves = Leaves::new(face, low, high, &mut slots);
    let mut least = ends(&tile.views.least).0;
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
            while seen != 0 {
                let i = seen.trailing_zeros() as usize & (OCTETS - 1);
                seen &= seen - 1;
                let sifted = K::shade(&face.sights[entry.sight as usize], &tile.octets[i]);
                let uncertain = sifted.possible & !sifted.certain;
                let looked = if uncertain != 0 { look::<K::Eight>(face, entry, i, uncertain, rays, tile) } else { 0 };
                let stopped = sifted.certain | looked;
                if stopped != 0 {
                    tile.stop::<K>(i, stopped);
                    least = ends(&tile.views.least).0;
                }
            }
        }
    }
    true
}

/// THE triangle test of those of an octet's rays that a triangle may stop; also notes where it lies between their end and the eye.
#[inline(always)]
fn look<E: Eight>(face: &Face, entry: &Entry, octet: usize, lanes: u32, rays: &[Ray], tile: &mut Tile) -> u32 {
    tile.effort.test();
    let (index, last) = (entry.sight as usize, rays.len() - 1);
    let [ox, oy, oz, dx, dy, dz, t_min, t_max] = E::transposed(|lane| rays[(octet * RAYS + lane).min(last)].numbers());
    let (origin, direction_z) = match face.side.axes() {
        [1, 2, 0] => ([oy, oz, ox], dx),
        [2, 0, 1] => ([oz, ox, oy], dy),
        _ => ([ox, oy, oz], dz),
    };
    let shade = &tile.octets[octet];
    let shear @ [u, v] = [E::load(&shade.u), E::load(&shade.v)];
    let [a, b, c] = &face.corners[index];
    let corners =
        [sheared(&splat(a), &origin, &shear), sheared(&splat(b), &origin, &shear), sheared(&splat(c), &origin, &shear)];
    let stopped = E::hits(&corners, direction_z, t_min, t_max).accepted & lanes;
    let nearest = face.sights[index].nearest(u, v);
    let beyond = E::load(&shade.near_surely).le(nearest).signs() & lanes & !stopped;
    tile.asked[octet] |= beyond as u8;
    stopped
}

/// A corner, for all rays.
#[inline(always)]
fn splat<E: Eight>(&[x, y, z, _]: &[f32; 4]) -> [E; 3] {
    [E::splat(x), E::splat(y), E::splat(z)]
}
