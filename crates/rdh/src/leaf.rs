//! Leaves: eight triangles at a time are sifted, what is left goes through THE triangle test, and a collector takes the hits.
//!
//! Shared by all structures, so that they cannot disagree about what a hit is.

use crate::geom::{GeomId, Hit, InstId, Ray, RayFrame, TriId, hit_sheared, owns_crossing};
use crate::simd::{Block, Kernels, LANES};

/// What a hit was found with.
pub(crate) struct Seen {
    frame: RayFrame,
    corners: [[f32; 3]; 3],
}

/// What becomes of hits.
pub(crate) trait Collector {
    /// What it begins with.
    type Start;

    /// Whether hits may come in any order, since one is enough or all are wanted: then the likeliest triangles come first, not the
    /// nearest.
    const ANY: bool = false;

    /// Whether it matters what is hit; if not, the test itself can be spared where its outcome is certain.
    const SEES_HITS: bool = true;

    /// What comes of it.
    type Output;

    /// Nothing collected yet.
    fn new(start: Self::Start) -> Self;

    /// What was collected.
    fn finish(self) -> Self::Output;

    /// Learns that there is a hit, where any will do.
    #[inline(always)]
    fn certain(&mut self) {}

    /// Takes a hit; returns the largest `t` that is still of interest, or nothing if the ray is done.
    /// `t_max` is what was of interest so far.
    fn take(&mut self, hit: Hit, t_max: f32, seen: impl FnOnce() -> Seen) -> Option<f32>;
}

/// The nearest hit. Not an `Option<Hit>`: that is put together from halves and read as a whole, which waits for the halves to be
/// stored, ten cycles and more a ray.
pub(crate) struct Closest {
    best: Hit,
    is_hit: bool,
}

impl Closest {
    /// Whether a hit is nearer than the nearest so far.
    #[inline(always)]
    fn is_beaten_by(&self, hit: &Hit) -> bool {
        !self.is_hit || hit.wins_over(&self.best)
    }

    #[inline(always)]
    fn keep(&mut self, hit: Hit) {
        (self.best, self.is_hit) = (hit, true);
    }
}

impl Collector for Closest {
    type Start = ();
    type Output = Option<Hit>;

    #[inline(always)]
    fn new((): ()) -> Self {
        let best = Hit { t: 0.0, u: 0.0, v: 0.0, tri: TriId(0), geometry: GeomId(0), instance: InstId(0) };
        Self { best, is_hit: false }
    }

    #[inline(always)]
    fn finish(self) -> Option<Hit> {
        self.is_hit.then_some(self.best)
    }

    #[inline(always)]
    fn take(&mut self, hit: Hit, _t_max: f32, _seen: impl FnOnce() -> Seen) -> Option<f32> {
        if self.is_beaten_by(&hit) {
            self.keep(hit);
        }
        Some(self.best.t)
    }
}

/// Whether there is any hit.
pub(crate) struct Any(pub(crate) bool);

impl Collector for Any {
    const ANY: bool = true;
    const SEES_HITS: bool = false;
    type Start = ();
    type Output = bool;

    #[inline(always)]
    fn new((): ()) -> Self {
        Self(false)
    }

    #[inline(always)]
    fn finish(self) -> bool {
        self.0
    }

    #[inline(always)]
    fn certain(&mut self) {
        self.0 = true;
    }

    #[inline(always)]
    fn take(&mut self, _hit: Hit, _t_max: f32, _seen: impl FnOnce() -> Seen) -> Option<f32> {
        self.0 = true;
        None
    }
}

/// What decides whether a hit counts: see [`Accel::closest_where`](crate::Accel::closest_where).
pub(crate) type Filter<'a> = &'a mut dyn FnMut(&Hit) -> bool;

/// The nearest hit that a filter lets pass. It is asked about hits that would win, in any order.
pub(crate) struct ClosestWhere<'a> {
    nearest: Closest,
    passes: Filter<'a>,
}

impl<'a> Collector for ClosestWhere<'a> {
    type Start = Filter<'a>;
    type Output = Option<Hit>;

    #[inline(always)]
    fn new(passes: Filter<'a>) -> Self {
        Self { nearest: Closest::new(()), passes }
    }

    #[inline(always)]
    fn finish(self) -> Option<Hit> {
        self.nearest.finish()
    }

    #[inline(always)]
    fn take(&mut self, hit: Hit, t_max: f32, _seen: impl FnOnce() -> Seen) -> Option<f32> {
        if self.nearest.is_beaten_by(&hit) && (self.passes)(&hit) {
            self.nearest.keep(hit);
        }
        Some(if self.nearest.is_hit { self.nearest.best.t } else { t_max })
    }
}

/// Whether there is a hit that a filter lets pass.
pub(crate) struct AnyWhere<'a> {
    found: bool,
    passes: Filter<'a>,
}

impl<'a> Collector for AnyWhere<'a> {
    const ANY: bool = true;
    type Start = Filter<'a>;
    type Output = bool;

    #[inline(always)]
    fn new(passes: Filter<'a>) -> Self {
        Self { found: false, passes }
    }

    #[inline(always)]
    fn finish(self) -> bool {
        self.found
    }

    #[inline(always)]
    fn take(&mut self, hit: Hit, t_max: f32, _seen: impl FnOnce() -> Seen) -> Option<f32> {
        self.found = (self.passes)(&hit);
        if self.found { None } else { Some(t_max) }
    }
}

/// All hits that own their crossing; one that lies in several cells comes several times.
pub(crate) struct All<'a>(pub(crate) &'a mut Vec<Hit>);

impl<'a> Collector for All<'a> {
    const ANY: bool = true;
    type Start = &'a mut Vec<Hit>;
    type Output = ();

    #[inline(always)]
    fn new(hits: &'a mut Vec<Hit>) -> Self {
        Self(hits)
    }

    #[inline(always)]
    fn finish(self) {}

    #[inline(always)]
    fn take(&mut self, hit: Hit, t_max: f32, seen: impl FnOnce() -> Seen) -> Option<f32> {
        let owns = is_amid(&hit) || {
            let Seen { frame, corners } = seen();
            owns_crossing(&frame, &corners)
        };
        if owns {
            self.0.push(hit);
        }
        Some(t_max)
    }
}

/// Whether a hit is surely on no edge: none of its three weights can be a rounded 0. Nearly all hits are spared the exact question.
fn is_amid(hit: &Hit) -> bool {
    hit.u > 0.0 && hit.v > 0.0 && hit.u + hit.v < 1.0 - 8.0 * f32::EPSILON
}

/// Nearest first, then by id; each triangle once.
pub(crate) fn in_order(hits: &mut Vec<Hit>) {
    hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.tri.cmp(&b.tri)));
    hits.dedup_by_key(|h| h.tri);
}

/// One ray's tests of the triangles in leaves.
pub(crate) struct Tester<'a, K: Kernels> {
    frame: K::Frame,
    t_min: f32,
    /// The end of interest.
    t_max: f32,
    ray_mask: u32,
    masks: Option<&'a [u32]>,
}

impl<'a, K: Kernels> Tester<'a, K> {
    /// Prepares a valid ray.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, masks: Option<&'a [u32]>) -> Self {
        Self { frame: K::frame(ray), t_min: ray.t_min, t_max: ray.t_max, ray_mask: ray.mask, masks }
    }

    /// The end of interest, in the ray's own `t`.
    #[inline(always)]
    pub(crate) fn t_max(&self) -> f32 {
        self.t_max
    }

    /// Tests `count` triangles that begin in a lane of the first block: whether the end of interest has moved; nothing if
    /// the ray is done.
    #[inline(always)]
    pub(crate) fn test_run<C: Collector>(
        &mut self,
        blocks: &[Block],
        lane: u32,
        count: u32,
        collector: &mut C,
    ) -> Option<bool> {
        let (mut moved, mut left, mut lane) = (false, count, lane);
        for block in blocks {
            let here = left.min(LANES as u32 - lane);
            moved |= self.test(block, ((1u32 << here) - 1) << lane, collector)?;
            left -= here;
            lane = 0;
            if left == 0 {
                break;
            }
        }
        Some(moved)
    }

    /// Tests the `wanted` lanes of a block: whether the end of interest has moved; nothing if the ray is done.
    #[inline(always)]
    pub(crate) fn test<C: Collector>(&mut self, block: &Block, wanted: u32, collector: &mut C) -> Option<bool> {
        let sheared = K::shear(&self.frame, block);
        let mut candidates = K::inside(&sheared, wanted);
        // The triangle that a ray has just left is all that closest hits can be spared for sure: for the others they need the test.
        if candidates != 0 && (!C::SEES_HITS || K::is_left(&self.frame, &sheared, candidates, self.t_min)) {
            let reached = K::reached(&self.frame, &sheared, candidates, (self.t_min, self.t_max));
            if !C::SEES_HITS && reached.certain != 0 && self.masks.is_none() {
                collector.certain();
                return None;
            }
            candidates = reached.possible;
        }
        let mut moved = false;
        while candidates != 0 {
            let i = candidates.trailing_zeros() as usize & (LANES - 1);
            candidates &= candidates - 1;
            let (id, interval) = (block.ids[i], (self.t_min, self.t_max));
            let hit = hit_sheared(&K::corners(&sheared, i), K::direction_z(&self.frame), interval, TriId(id));
            let Some(hit) = hit else { continue };
            if self.masks.is_some_and(|m| m[id as usize] & self.ray_mask == 0) {
                continue;
            }
            let seen = || Seen { frame: K::ray_frame(&self.frame, interval), corners: block.corners(i) };
            let t_max = collector.take(hit, self.t_max, seen)?;
            if t_max < self.t_max {
                self.t_max = t_max;
                moved = true;
            }
        }
        Some(moved)
    }
}
