//! Many rays towards the eye: as [`super::tile`], but any hit will do, and what is certain needs no test at all.

use super::EyeTree;
use super::effort::Effort;
use super::face::Face;
use super::side::Side;
use super::towards::Approach;
use super::walk::{Leaves, WalkSlots};
use crate::geom::{Ray, RayFrame};
use crate::simd::{Entry, Job, Kernels, RAYS, Shade, Views, step_of};

/// Octets of a tile.
const OCTETS: usize = 8;
/// Rays of a tile.
pub(super) const TILE: usize = OCTETS * RAYS;

/// All rays of a batch.
pub(super) struct Occluded<'a> {
    pub(super) tree: &'a EyeTree,
    pub(super) rays: &'a [Ray],
    pub(super) found: &'a mut [bool],
}

impl Job for Occluded<'_> {
    /// What it took.
    type Output = Effort;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Effort {
        let mut tile = Tile::NEW;
        for (rays, found) in self.rays.chunks(TILE).zip(self.found.chunks_mut(TILE)) {
            let mut wanted = 0u8;
            for (i, ray) in rays.iter().enumerate() {
                tile.sides[i] = Tile::STRAY;
                match self.tree.approaching(ray) {
                    Some((face, frame, approach)) => {
                        (tile.frames[i], tile.approaches[i]) = (frame, approach);
                        tile.sides[i] = face.side.index() as u8;
                        wanted |= 1 << face.side.index();
                    }
                    None => {
                        found[i] = self.tree.occluded(ray);
                        tile.effort.alone(1);
                    }
                }
            }
            while wanted != 0 {
                let side = wanted.trailing_zeros() as u8;
                wanted &= wanted - 1;
                tile.take(rays.len(), side);
                if let Some(face) = &self.tree.faces[side as usize] {
                    one_side::<K>(self.tree, face, rays, found, &mut tile);
                }
            }
        }
        tile.effort
    }
}

/// Rays from one side.
struct Tile {
    octets: [Shade; OCTETS],
    views: Views,
    /// Of all rays of the chunk: what they are made ready to, and the side of each.
    frames: [RayFrame; TILE],
    approaches: [Approach; TILE],
    sides: [u8; TILE],
    /// Which of them each ray of the tile is.
    order: [u8; TILE],
    len: usize,
    low: [f32; 2],
    high: [f32; 2],
    /// Rays that have met something between their end and the eye: a bit a lane.
    beyond: [u8; OCTETS],
    done: [u8; OCTETS],
    effort: Effort,
}

const DONE: Shade = Shade {
    u: [0.0; RAYS],
    v: [0.0; RAYS],
    far: [f32::INFINITY; RAYS],
    far_surely: [f32::INFINITY; RAYS],
    near_surely: [f32::NEG_INFINITY; RAYS],
};

const NO_FRAME: RayFrame =
    RayFrame { k: [0, 1, 2], origin: [0.0; 3], shear: [0.0; 2], direction_z: 1.0, t_min: 0.0, t_max: 0.0 };

impl Tile {
    /// The side of rays that are answered elsewhere.
    const STRAY: u8 = Side::COUNT as u8;

    const NEW: Self = Self {
        octets: [DONE; OCTETS],
        views: Views::NONE,
        frames: [NO_FRAME; TILE],
        approaches: [Approach { far: 0.0, far_surely: 0.0, near_surely: 0.0 }; TILE],
        sides: [Self::STRAY; TILE],
        order: [0; TILE],
        len: 0,
        low: [0.0; 2],
        high: [0.0; 2],
        beyond: [0; OCTETS],
        done: [0; OCTETS],
        effort: Effort::NONE,
    };

    /// Takes in the rays of one side.
    #[inline(always)]
    fn take(&mut self, rays: usize, side: u8) {
        self.len = 0;
        (self.low, self.high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        (self.views, self.octets) = (Views::NONE, [DONE; OCTETS]);
        (self.beyond, self.done) = ([0; OCTETS], [0; OCTETS]);
        for i in 0..rays {
            if self.sides[i] != side {
                continue;
            }
            let (shear, approach) = (self.frames[i].shear, self.approaches[i]);
            let (octet, lane) = (self.len / RAYS, self.len % RAYS);
            let shade = &mut self.octets[octet];
            [shade.u[lane], shade.v[lane]] = shear;
            (shade.far[lane], shade.far_surely[lane]) = (approach.far, approach.far_surely);
            shade.near_surely[lane] = approach.near_surely;
            self.order[self.len] = i as u8;
            for (a, &x) in shear.iter().enumerate() {
                let step = step_of(x);
                let (low, high) = (&mut self.views.low[a][octet], &mut self.views.high[a][octet]);
                (*low, *high) = ((*low).min(step), (*high).max(step));
                (self.low[a], self.high[a]) = (self.low[a].min(x), self.high[a].max(x));
            }
            self.views.least[octet] = self.views.least[octet].min(approach.far);
            self.len += 1;
        }
    }
}

/// The answers of rays from one side.
#[inline(always)]
fn one_side<K: Kernels>(tree: &EyeTree, face: &Face, rays: &[Ray], found: &mut [bool], tile: &mut Tile) {
    if tile.len == 0 {
        return;
    }
    if !face.takes(tile.low, tile.high) || !tree.drops_hidden() {
        for &i in &tile.order[..tile.len] {
            found[i as usize] = tree.occluded(&rays[i as usize]);
        }
        return tile.effort.alone(tile.len);
    }
    tile.effort.approach(tile.len);
    let mut slots = WalkSlots::new();
    let mut leaves = Leaves::new(face, tile.low, tile.high, &mut slots);
    let mut least = smallest(&tile.views.least);
    while let Some(entries) = leaves.next() {
        for entry in entries {
            if entry.near < least {
                break;
            }
            let mut seen = K::in_view(entry, &tile.views);
            tile.effort.look(seen.count_ones());
            while seen != 0 {
                let i = seen.trailing_zeros() as usize & (OCTETS - 1);
                seen &= seen - 1;
                let sifted = K::shade(&face.sights[entry.sight as usize], &tile.octets[i]);
                let uncertain = sifted.possible & !sifted.certain;
                tile.effort.test(uncertain.count_ones());
                let looked = if uncertain != 0 { look(tree, face, entry, i, uncertain, rays, tile) } else { 0 };
                let stopped = sifted.certain | looked;
                if stopped != 0 {
                    tile.stop(i, stopped);
                    least = smallest(&tile.views.least);
                }
            }
        }
    }
    for (k, &i) in tile.order[..tile.len].iter().enumerate() {
        let (octet, bit) = (k / RAYS, 1u8 << (k % RAYS));
        let stopped = tile.done[octet] & bit != 0;
        let beyond = tile.beyond[octet] & bit != 0;
        found[i as usize] = stopped || beyond && tree.world.occluded(&rays[i as usize]);
        tile.effort.alone(usize::from(beyond && !stopped));
    }
}

impl Tile {
    /// Some rays of an octet are done.
    #[inline(always)]
    fn stop(&mut self, octet: usize, stopped: u32) {
        self.done[octet] |= stopped as u8;
        let mut left = stopped;
        while left != 0 {
            self.octets[octet].far[left.trailing_zeros() as usize & (RAYS - 1)] = f32::INFINITY;
            left &= left - 1;
        }
        self.views.least[octet] = smallest(&self.octets[octet].far);
    }
}

/// THE triangle test of those of an octet's rays which a triangle may stop; also notes where it lies between their end and the eye.
#[inline(never)]
fn look(tree: &EyeTree, face: &Face, entry: &Entry, octet: usize, lanes: u32, rays: &[Ray], tile: &mut Tile) -> u32 {
    let (mut stopped, mut left) = (0, lanes);
    let sight = &face.sights[entry.sight as usize];
    while left != 0 {
        let lane = left.trailing_zeros() as usize & (RAYS - 1);
        left &= left - 1;
        let i = tile.order[octet * RAYS + lane] as usize;
        let shade = &tile.octets[octet];
        if tree.stops(face, entry.sight, &tile.frames[i], &rays[i]) {
            stopped |= 1 << lane;
        } else if sight.span(shade.u[lane], shade.v[lane]).1 >= shade.near_surely[lane] {
            tile.beyond[octet] |= 1 << lane;
        }
    }
    stopped
}

/// The smallest of eight numbers.
#[inline(always)]
fn smallest(x: &[f32; RAYS]) -> f32 {
    x.iter().fold(f32::INFINITY, |least, &x| if x < least { x } else { least })
}
