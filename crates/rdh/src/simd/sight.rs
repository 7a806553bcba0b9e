//! Triangles as an eye sees them, and eight rays of that eye: what its trees compare.
//!
//! Over the eye's picture plane, `(u, v, 1)`, everything about a triangle is linear: the edge functions, and the reciprocal of the
//! depth, here *nearness*. Edge functions are given in units of their own margin, so that one comparison with −1 says that THE triangle
//! test might accept the ray, and one with 1 that it surely does, but for the ray's interval (`eye/project.rs`).
//!
//! The functions here are the plain loops that faster levels must agree with.

use super::{Eight, Sifted};
use crate::geom::{Ray, RayFrame, TriId, Vec3, hit_triangle};

/// Rays that are compared at once.
pub(crate) const RAYS: usize = 8;

/// A triangle as seen from the eye: a cache line.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Sight {
    /// The three edge functions, in units of their margins: positive inside.
    pub(crate) edges: [[f32; 3]; 3],
    /// 1 / depth.
    pub(crate) nearness: [f32; 3],
    /// What the nearness may be off: in parts of it, and beside that.
    pub(crate) slack: [f32; 2],
    /// No hit is nearer.
    pub(crate) near: f32,
    /// Which triangle.
    pub(crate) id: u32,
}

impl Sight {
    /// The least of the edge functions.
    #[inline(always)]
    pub(crate) fn inside(&self, u: f32, v: f32) -> f32 {
        let [a, b, c] = &self.edges;
        let (a, b, c) = (form(a, u, v), form(b, u, v), form(c, u, v));
        let least = if a < b { a } else { b };
        if least < c { least } else { c }
    }

    /// The least and the largest nearness of a hit.
    #[inline(always)]
    pub(crate) fn span(&self, u: f32, v: f32) -> (f32, f32) {
        let nearness = form(&self.nearness, u, v);
        let slack = nearness * self.slack[0] + self.slack[1];
        (nearness - slack, nearness + slack)
    }

    /// The largest nearness of a hit, of eight places.
    #[inline(always)]
    pub(crate) fn nearest<E: Eight>(&self, u: E, v: E) -> E {
        let ([a, b, c], [part, rest]) = (self.nearness, self.slack);
        let nearness = E::splat(a).mul_add(u, E::splat(b).mul_add(v, E::splat(c)));
        nearness.add(nearness.mul_add(E::splat(part), E::splat(rest)))
    }
}

#[inline(always)]
fn form(f: &[f32; 3], u: f32, v: f32) -> f32 {
    f[0] * u + (f[1] * v + f[2])
}

/// Numbers a picture's coordinate, from −1 to 1, in steps; in its order, so that what lies in an interval is numbered in it.
#[inline(always)]
pub(crate) fn step_of(x: f32) -> i16 {
    (x * 32_000.0).clamp(-32_767.0, 32_767.0).floor() as i16
}

/// A triangle in a leaf.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(16))]
pub(crate) struct Entry {
    /// Its box in the picture, in steps: lower u and v, …
    pub(crate) low: [i16; 2],
    /// … upper u and v.
    pub(crate) high: [i16; 2],
    /// In the leaf's cell no hit is nearer.
    pub(crate) near: f32,
    /// Which [`Sight`].
    pub(crate) sight: u32,
}

/// The boxes of eight octets in the picture, and what is still of interest to them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Views {
    /// Nothing that is less near.
    pub(crate) least: [f32; RAYS],
    /// `low[axis][octet]`, in steps.
    pub(crate) low: [[i16; RAYS]; 2],
    /// `high[axis][octet]`.
    pub(crate) high: [[i16; RAYS]; 2],
}

impl Views {
    /// Of no rays.
    pub(crate) const NONE: Self =
        Self { least: [f32::INFINITY; RAYS], low: [[i16::MAX; RAYS]; 2], high: [[i16::MIN; RAYS]; 2] };
}

/// Eight rays from the eye, and the triangles that each may hit first.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Octet {
    pub(crate) u: [f32; RAYS],
    pub(crate) v: [f32; RAYS],
    /// The hit is at least as near as this, …
    pub(crate) least: [f32; RAYS],
    /// … and none that was looked at is nearer than this.
    pub(crate) most: [f32; RAYS],
    /// Which [`Sight`]s may be hit first, those of the first row before those of the others.
    pub(crate) best: [[u32; RAYS]; Self::CANDIDATES],
    /// Rays with more of them than one: a bit a lane.
    pub(crate) several: u32,
    /// Rays with more than there is room for.
    pub(crate) unsure: u32,
}

impl Octet {
    /// No sight.
    pub(crate) const NONE: u32 = u32::MAX;
    /// So many triangles of which the margins don't tell which is hit first, if any: surfaces lie on surfaces, and have edges.
    pub(crate) const CANDIDATES: usize = 3;

    /// Nothing met yet.
    pub(crate) const NEW: Self = Self {
        u: [0.0; RAYS],
        v: [0.0; RAYS],
        least: [f32::MIN; RAYS],
        most: [f32::MIN; RAYS],
        best: [[Self::NONE; RAYS]; Self::CANDIDATES],
        several: 0,
        unsure: 0,
    };
}

/// Eight rays towards the eye.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Shade {
    pub(crate) u: [f32; RAYS],
    pub(crate) v: [f32; RAYS],
    /// What is not nearer is no hit: it lies behind the ray's start. Infinite for a ray that is done.
    pub(crate) far: [f32; RAYS],
    /// What is nearer than this begins in the interval.
    pub(crate) far_surely: [f32; RAYS],
    /// What is less near than this ends in the interval.
    pub(crate) near_surely: [f32; RAYS],
}

impl Shade {
    /// Rays that are done.
    pub(crate) const DONE: Self = Self {
        u: [0.0; RAYS],
        v: [0.0; RAYS],
        far: [f32::INFINITY; RAYS],
        far_surely: [f32::INFINITY; RAYS],
        near_surely: [f32::NEG_INFINITY; RAYS],
    };

    /// Some of them are done, a bit a lane.
    #[inline(always)]
    pub(crate) fn finish<E: Eight>(&mut self, done: u32) {
        // Infinite ends are what no triangle is nearer than.
        self.far = *E::mask(done).select(E::splat(f32::INFINITY), E::load(&self.far)).lanes();
    }
}

/// Eight rays made ready for THE triangle test, and the side of the eye to which each belongs.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Aims {
    /// [`RayFrame::shear`]: the place in the picture.
    pub(crate) shear: [[f32; RAYS]; 2],
    /// [`RayFrame::direction_z`].
    pub(crate) direction_z: [f32; RAYS],
    pub(crate) t_min: [f32; RAYS],
    pub(crate) t_max: [f32; RAYS],
    /// Twice the longest axis, and 1 more if the ray runs down it; [`Aims::STRAY`] for rays that are none of this eye.
    pub(crate) side: [u32; RAYS],
}

impl Aims {
    /// The side of a ray that is to be traced elsewhere.
    pub(crate) const STRAY: u32 = 6;
    /// Rays are strays whose longest component is shorter than this, …
    pub(crate) const SHORTEST: f32 = 1.0 / (1u64 << 40) as f32;
    /// … or longer.
    pub(crate) const LONGEST: f32 = (1u64 << 40) as f32;
}

/// The corners of a triangle along the axes of a side; the fourth numbers are none: they hold the bits of the triangle's id.
pub(crate) type Corners = [[f32; 4]; 3];

/// What eight rays met.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Met {
    pub(crate) t: [f32; RAYS],
    pub(crate) u: [f32; RAYS],
    pub(crate) v: [f32; RAYS],
    /// Which of them are hits: a bit a lane.
    pub(crate) hits: u32,
}

/// Which octets a triangle may be of interest to.
#[inline(always)]
pub(super) fn in_view(entry: &Entry, views: &Views) -> u32 {
    let mut seen = 0;
    for i in 0..RAYS {
        let beside = (entry.low[0] > views.high[0][i])
            | (entry.low[1] > views.high[1][i])
            | (entry.high[0] < views.low[0][i])
            | (entry.high[1] < views.low[1][i]);
        seen |= u32::from(!beside & (entry.near >= views.least[i])) << i;
    }
    seen
}

/// Compares a triangle with eight rays; whether anything has changed.
#[inline(always)]
pub(super) fn see(sight: &Sight, index: u32, octet: &mut Octet) -> bool {
    let mut changed = false;
    for i in 0..RAYS {
        let (u, v) = (octet.u[i], octet.v[i]);
        let inside = sight.inside(u, v);
        let (low, high) = sight.span(u, v);
        if !(inside >= -1.0 && high >= octet.least[i]) || octet.best.iter().any(|best| best[i] == index) {
            continue;
        }
        changed = true;
        let (certain, bit) = (inside > 1.0, 1 << i);
        if certain && low > octet.most[i] {
            (octet.least[i], octet.most[i]) = (low, high);
            for (row, best) in octet.best.iter_mut().enumerate() {
                best[i] = if row == 0 { index } else { Octet::NONE };
            }
            octet.several &= !bit;
            octet.unsure &= !bit;
            continue;
        }
        octet.most[i] = if high > octet.most[i] { high } else { octet.most[i] };
        if certain && low > octet.least[i] {
            octet.least[i] = low;
        }
        match octet.best.iter().position(|best| best[i] == Octet::NONE) {
            Some(row) => {
                octet.best[row][i] = index;
                octet.several |= if row > 0 { bit } else { 0 };
            }
            None => octet.unsure |= bit,
        }
    }
    changed
}

/// Which of eight rays towards the eye a triangle may stop, were they to end at the eye, and which it surely does.
#[inline(always)]
pub(super) fn shade(sight: &Sight, rays: &Shade) -> Sifted {
    let mut sifted = Sifted { possible: 0, certain: 0 };
    for i in 0..RAYS {
        let inside = sight.inside(rays.u[i], rays.v[i]);
        let (low, high) = sight.span(rays.u[i], rays.v[i]);
        let possible = (inside >= -1.0) & (high > rays.far[i]);
        let certain = (inside > 1.0) & (low > rays.far_surely[i]) & (high < rays.near_surely[i]);
        sifted.possible |= u32::from(possible) << i;
        sifted.certain |= u32::from(possible & certain) << i;
    }
    sifted
}

/// Makes eight rays ready that start at the eye, bit for bit.
#[inline(always)]
pub(super) fn aim(rays: &[&Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
    for (i, ray) in rays.iter().enumerate() {
        let frame = RayFrame::new(ray);
        let [dx, dy, dz] = ray.direction;
        let reach = frame.direction_z.abs();
        let own = ray.origin.map(f32::to_bits) == eye.map(f32::to_bits)
            && dx * 0.0 + dy * 0.0 + dz * 0.0 == 0.0
            && (Aims::SHORTEST..=Aims::LONGEST).contains(&reach)
            && ray.t_min >= 0.0
            && ray.t_min <= ray.t_max;
        let side = 2 * frame.k[2] as u32 + u32::from(frame.direction_z < 0.0);
        (aims.shear[0][i], aims.shear[1][i], aims.direction_z[i]) = (frame.shear[0], frame.shear[1], frame.direction_z);
        (aims.t_min[i], aims.t_max[i]) = (ray.t_min, ray.t_max);
        aims.side[i] = if own { side } else { Aims::STRAY };
    }
}

/// THE triangle test of eight rays from the eye, given along the side's axes, each with a triangle of its own.
#[inline(always)]
pub(super) fn meet_own(aims: &Aims, eye: &Vec3, corners: &[&Corners; RAYS], met: &mut Met) {
    met.hits = 0;
    for (i, corners) in corners.iter().enumerate() {
        let frame = RayFrame {
            k: [0, 1, 2],
            origin: *eye,
            shear: [aims.shear[0][i], aims.shear[1][i]],
            direction_z: aims.direction_z[i],
            t_min: aims.t_min[i],
            t_max: aims.t_max[i],
        };
        let corners = corners.map(|[x, y, z, _]| [x, y, z]);
        if let Some(hit) = hit_triangle(&frame, &corners, TriId(0)) {
            (met.t[i], met.u[i], met.v[i]) = (hit.t, hit.u, hit.v);
            met.hits |= 1 << i;
        }
    }
}
