//! Eight or sixteen rays side by side, all in the same octant and with the same longest axis: what boxes and triangles ask of them.
//!
//! Boxes get the constants of single rays, so that what is said of those (docs/watertight.md, section 4) holds lane by lane; triangles
//! are sifted by the operations of single rays, and what is left goes through THE triangle test, side by side as well.

use crate::geom::{GeomId, Hit, InstId, PlaneFrame, Ray, TriId};
use crate::simd::{Block, Boxes, Eight, Floats, Hits, LANES, Sifted, all_lanes, reached_side_by_side, sheared, size};

/// What rays of a tile have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Class {
    /// A bit an axis: 1 where they run down the axis.
    pub(crate) down: u32,
    /// The axes of their frames.
    axes: [usize; 3],
}

impl Class {
    /// Rays that run down some axes, and along one most.
    #[inline(always)]
    pub(crate) fn new(down: u32, main: usize) -> Self {
        Self { down, axes: [[1, 2, 0], [2, 0, 1], [0, 1, 2]][main.min(2)] }
    }

    /// 1 where they meet a box's upper plane first.
    #[inline(always)]
    pub(crate) fn near(self, axis: usize) -> usize {
        (self.down >> axis & 1) as usize
    }
}

/// Origins, directions and intervals of a packet's rays, axis by axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loaded<R> {
    origin: [R; 3],
    direction: [R; 3],
    t_min: R,
    t_max: R,
}

impl<R: Floats> Loaded<R> {
    /// No rays.
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        let zero = R::splat(0.0);
        Self { origin: [zero; 3], direction: [zero; 3], t_min: zero, t_max: zero }
    }

    /// Rays, by their lanes.
    #[inline(always)]
    pub(crate) fn new<'a>(ray: impl Fn(usize) -> &'a Ray) -> Self {
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] = R::transposed(|lane| ray(lane).numbers());
        Self { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
    }

    /// Rays that need no care: valid, neither far away nor of extreme length.
    #[inline(always)]
    pub(crate) fn usual(&self) -> u32 {
        let (far, long) = (R::splat(PlaneFrame::FAR.next_down()), R::splat(PlaneFrame::LONG));
        let [ox, oy, oz] = [size(self.origin[0]), size(self.origin[1]), size(self.origin[2])];
        let [dx, dy, dz] = [size(self.direction[0]), size(self.direction[1]), size(self.direction[2])];
        let near = ox.le(far).and(oy.le(far)).and(oz.le(far));
        let short = dx.le(long).and(dy.le(long)).and(dz.le(long));
        let least = R::splat(PlaneFrame::SHORT);
        let moves = least.le(dx).or(least.le(dy)).or(least.le(dz));
        near.and(short).and(moves).and(self.t_min.le(self.t_max)).signs()
    }

    /// Rays that run down the axes, and those that move most along x and along y; all others do along z.
    #[inline(always)]
    pub(crate) fn classes(&self) -> ([u32; 3], [u32; 2]) {
        let [x, y, z] = self.direction;
        let down = [x.signs(), y.signs(), z.signs()];
        let (x, y, z) = (size(x), size(y), size(z));
        let (x_over_y, y_over_z, x_over_z) = (y.lt(x).signs(), z.lt(y).signs(), z.lt(x).signs());
        // As `RayFrame::new` has it.
        (down, [x_over_y & x_over_z, !x_over_y & y_over_z])
    }
}

/// Some rays, and what they have hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Packet<R> {
    pub(crate) inverse: [R; 3],
    enters: [R; 3],
    leaves: [R; 3],
    pub(crate) t_min: R,
    /// Where they end: at their nearest hits. Rays that are done, and lanes without one, end before everything.
    pub(crate) end: R,
    aim: Aim<R>,
    u: R,
    v: R,
    /// Ids of the triangles that were hit, as bits.
    tri: R,
    /// Rays that have hit something, a bit a lane.
    hit: u32,
    /// Their masks, as bits; only known where triangles have some.
    masks: R,
}

/// Rays as triangles see them.
#[derive(Debug, Clone, Copy)]
struct Aim<R> {
    /// Along the frame's axes.
    origin: [R; 3],
    shear: [R; 2],
    direction_z: R,
    t_min: R,
    depths: Limits<R>,
}

/// Limits for the depths of a triangle's corners: with all corners before `nearest` or behind `farthest` there is no hit. For usual
/// rays alone: a `t` that is rounded to f32's smallest steps moves their depth by less than 2⁻¹⁴⁰.
#[derive(Debug, Clone, Copy)]
struct Limits<R> {
    nearest: R,
    farthest: R,
}

impl<R: Floats> Limits<R> {
    /// More than all roundings on the way from a limit of `t` to a depth, as a part of it.
    const SLACK: f32 = 1.0 / (1 << 20) as f32;

    #[inline(always)]
    fn new(t_min: R, t_max: R, direction_z: R) -> Self {
        let a = t_min.max(R::splat(f32::MIN)).mul(direction_z);
        let b = t_max.min(R::splat(f32::MAX)).mul(direction_z);
        let (low, high) = (a.min(b), a.max(b));
        let (slack, least) = (R::splat(Self::SLACK), R::splat(f32::MIN_POSITIVE));
        let (low_slack, high_slack) = (size(low).mul(slack).add(least), size(high).mul(slack).add(least));
        Self { nearest: low.sub(low_slack), farthest: high.add(high_slack) }
    }

    #[inline(always)]
    fn spread(&self, lane: usize) -> Limits<R::Eight> {
        Limits { nearest: spread(&self.nearest, lane), farthest: spread(&self.farthest, lane) }
    }
}

impl<R: Floats> Aim<R> {
    /// A lane's, for eight triangles.
    #[inline(always)]
    fn spread(&self, lane: usize) -> Aim<R::Eight> {
        let [ox, oy, oz] = &self.origin;
        let [sx, sy] = &self.shear;
        Aim {
            origin: [spread(ox, lane), spread(oy, lane), spread(oz, lane)],
            shear: [spread(sx, lane), spread(sy, lane)],
            direction_z: spread(&self.direction_z, lane),
            t_min: spread(&self.t_min, lane),
            depths: self.depths.spread(lane),
        }
    }

    /// Corners, along the frame's axes, in the rays' frames.
    #[inline(always)]
    fn shear(&self, [a, b, c]: &[[R; 3]; 3]) -> [[R; 3]; 3] {
        let (origin, shear) = (&self.origin, &self.shear);
        [sheared(a, origin, shear), sheared(b, origin, shear), sheared(c, origin, shear)]
    }

    /// Which of the `wanted` lanes THE triangle test might accept, and, if it matters (`CERTAIN`), which it surely does
    /// (docs/watertight.md, section 7).
    #[inline(always)]
    fn sift<const CERTAIN: bool>(&self, corners: &[[R; 3]; 3], wanted: u32, t_max: R) -> Sifted {
        let [a, b, c] = corners;
        let (zero, depths) = (R::splat(0.0), &self.depths);
        let (u, v, w) = (cross(c, b), cross(a, c), cross(b, a));
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let (first, last) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let outside = least.lt(zero).and(zero.lt(most));
        let beyond = last.lt(depths.nearest).or(depths.farthest.lt(first));
        let possible = !outside.or(beyond).signs() & wanted;
        if !CERTAIN || possible == 0 {
            return Sifted { possible, certain: 0 };
        }
        // Most of those that are left are triangles that rays have just left: only bounds of `t` tell.
        let interval = (self.t_min, t_max);
        let reached = reached_side_by_side(&[u, v, w], (least, most), corners, self.direction_z, interval);
        Sifted { possible: possible & reached.possible, certain: possible & reached.certain }
    }
}

#[inline(always)]
fn cross<R: Floats>(a: &[R; 3], b: &[R; 3]) -> R {
    a[0].mul(b[1]).sub(a[1].mul(b[0]))
}

/// A ray's number, for eight triangles.
#[inline(always)]
fn spread<R: Floats>(x: &R, lane: usize) -> R::Eight {
    R::Eight::splat(x.lane(lane))
}

/// A box, each plane in all lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Planes<R> {
    near: [R; 3],
    far: [R; 3],
}

impl<R: Floats> Planes<R> {
    /// Of a box whose `near` planes rays meet first.
    #[inline(always)]
    pub(crate) fn of(near: &[f32; 3], far: &[f32; 3]) -> Self {
        Self {
            near: [R::splat(near[0]), R::splat(near[1]), R::splat(near[2])],
            far: [R::splat(far[0]), R::splat(far[1]), R::splat(far[2])],
        }
    }

    /// A box of a node, for rays of a class.
    #[inline(always)]
    pub(crate) fn new(boxes: &Boxes<8>, lane: usize, class: Class) -> Self {
        let (x, y, z) = (class.near(0), class.near(1), class.near(2));
        Self {
            near: [plane(boxes, x, 0, lane), plane(boxes, y, 1, lane), plane(boxes, z, 2, lane)],
            far: [plane(boxes, x ^ 1, 0, lane), plane(boxes, y ^ 1, 1, lane), plane(boxes, z ^ 1, 2, lane)],
        }
    }
}

#[inline(always)]
fn plane<R: Floats>(boxes: &Boxes<8>, side: usize, axis: usize, lane: usize) -> R {
    R::splat(boxes.planes[side & 1][axis][lane & 7])
}

/// What the rays' boxes reach, of one packet or several.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach<R> {
    pub(crate) inverse: [(R, R); 3],
    pub(crate) origin: [(R, R); 3],
    pub(crate) t_min: R,
    pub(crate) t_max: R,
}

impl<R: Floats> Reach<R> {
    /// Of no rays.
    #[inline(always)]
    pub(crate) fn nothing() -> Self {
        let (low, high) = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let none = (high, low);
        Self { inverse: [none; 3], origin: [none; 3], t_min: high, t_max: low }
    }
}

impl<R: Floats> Packet<R> {
    /// Nothing but empty lanes.
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        let zero = R::splat(0.0);
        let depths = Limits { nearest: zero, farthest: zero };
        let aim = Aim { origin: [zero; 3], shear: [zero; 2], direction_z: zero, t_min: zero, depths };
        let end = R::splat(f32::NEG_INFINITY);
        let three = [zero; 3];
        let (inverse, enters, leaves) = (three, three, three);
        Self { inverse, enters, leaves, t_min: zero, end, aim, u: zero, v: zero, tri: zero, hit: 0, masks: zero }
    }

    /// Takes over usual rays of one class; `filled` lanes hold one, the others repeat one. Widens what is reached.
    #[inline(always)]
    pub(crate) fn fill(&mut self, rays: &Loaded<R>, filled: u32, class: Class, magnitude: f32, reach: &mut Reach<R>) {
        let [ox, oy, oz] = rays.origin;
        let size_of_origin = size(ox).max(size(oy)).max(size(oz));
        let slack = size_of_origin.add(R::splat(magnitude)).mul(R::splat(1.0 / (1 << 21) as f32));
        let (sign, parallel) = (R::splat(-0.0), R::splat(PlaneFrame::PARALLEL));
        for a in 0..3 {
            let (origin, signs) = (rays.origin[a], rays.direction[a].and(sign));
            let inverse = R::splat(1.0).div(size(rays.direction[a]).max(parallel).or(signs));
            let (back, slack) = (origin.xor(sign), slack.or(signs));
            self.inverse[a] = inverse;
            self.enters[a] = back.sub(slack).mul(inverse);
            self.leaves[a] = back.add(slack).mul(inverse);
            reach.inverse[a].0 = reach.inverse[a].0.min(inverse);
            reach.inverse[a].1 = reach.inverse[a].1.max(inverse);
        }
        // Twice as wide as for single rays: the beam rounds once more.
        let twice = slack.add(slack);
        for a in 0..3 {
            reach.origin[a].0 = reach.origin[a].0.min(rays.origin[a].sub(twice));
            reach.origin[a].1 = reach.origin[a].1.max(rays.origin[a].add(twice));
        }
        self.t_min = rays.t_min;
        self.end = R::mask(filled).select(rays.t_max, R::splat(f32::NEG_INFINITY));
        reach.t_min = reach.t_min.min(self.t_min);
        reach.t_max = reach.t_max.max(self.end);
        let [kx, ky, kz] = class.axes;
        let direction_z = rays.direction[kz];
        self.aim = Aim {
            origin: [rays.origin[kx], rays.origin[ky], rays.origin[kz]],
            shear: [rays.direction[kx].div(direction_z), rays.direction[ky].div(direction_z)],
            direction_z,
            t_min: rays.t_min,
            depths: Limits::new(rays.t_min, rays.t_max, direction_z),
        };
        self.hit = 0;
    }

    /// Takes over the rays' masks.
    pub(crate) fn see(&mut self, mask: impl Fn(usize) -> u32) {
        for lane in 0..R::COUNT {
            self.masks.set_lane(lane, f32::from_bits(mask(lane)));
        }
    }

    /// The rays that meet a box, a bit a lane.
    #[inline(always)]
    pub(crate) fn meet(&self, planes: &Planes<R>) -> u32 {
        let (near, far) = (&planes.near, &planes.far);
        let (inverse, enters, leaves) = (&self.inverse, &self.enters, &self.leaves);
        let (near_x, far_x) = (near[0].mul_add(inverse[0], enters[0]), far[0].mul_add(inverse[0], leaves[0]));
        let (near_y, far_y) = (near[1].mul_add(inverse[1], enters[1]), far[1].mul_add(inverse[1], leaves[1]));
        let (near_z, far_z) = (near[2].mul_add(inverse[2], enters[2]), far[2].mul_add(inverse[2], leaves[2]));
        let first = near_x.max(near_y).max(near_z.max(self.t_min));
        let last = far_x.min(far_y).min(far_z.min(self.end));
        first.le(last).signs()
    }

    /// Whether a ray has hit something.
    #[inline(always)]
    pub(crate) fn has_hit(&self, lane: usize) -> bool {
        self.hit >> (lane & (R::COUNT - 1)) & 1 == 1
    }

    /// What a ray has hit.
    #[inline(always)]
    pub(crate) fn closest(&self, lane: usize) -> Option<Hit> {
        if !self.has_hit(lane) {
            return None;
        }
        let (t, u, v) = (self.end.lane(lane), self.u.lane(lane), self.v.lane(lane));
        let tri = TriId(self.tri.lane(lane).to_bits());
        Some(Hit { t, u, v, tri, geometry: GeomId(0), instance: InstId(0) })
    }
}

/// A leaf's triangles and what decides about them.
pub(crate) struct Leaf<'a> {
    pub(crate) block: &'a Block,
    pub(crate) wanted: u32,
    pub(crate) masks: Option<&'a [u32]>,
}

impl<R: Floats> Packet<R> {
    /// Tests the `rays` against a leaf, all triangles one after the other for all rays, or all rays one after the other for all
    /// triangles. Whether a ray ends earlier.
    #[inline(always)]
    pub(crate) fn test<const ANY: bool>(&mut self, leaf: &Leaf<'_>, rays: u32, class: Class) -> bool {
        if rays.count_ones() < leaf.wanted.count_ones() {
            self.test_rays::<ANY>(leaf, rays, class)
        } else {
            self.test_triangles::<ANY>(leaf, rays, class)
        }
    }

    #[inline(always)]
    fn test_triangles<const ANY: bool>(&mut self, leaf: &Leaf<'_>, mut rays: u32, class: Class) -> bool {
        let (mut wanted, mut moved) = (leaf.wanted, false);
        while wanted != 0 {
            let i = wanted.trailing_zeros() as usize & (LANES - 1);
            wanted &= wanted - 1;
            let corners = self.aim.shear(&corners_of(leaf.block, i, class.axes));
            let Sifted { mut possible, certain } = self.aim.sift::<ANY>(&corners, rays, self.end);
            let id = leaf.block.ids[i];
            if ANY && certain != 0 && leaf.masks.is_none() {
                moved = true;
                self.stop(certain);
                rays &= !certain;
                possible &= !certain;
            }
            if possible == 0 {
                continue;
            }
            let found = R::hits(&corners, self.aim.direction_z, self.t_min, self.end);
            let accepted = found.accepted & possible & self.seeing(leaf.masks, id);
            if accepted == 0 {
                continue;
            }
            if ANY {
                moved = true;
                self.stop(accepted);
                rays &= !accepted;
            } else {
                moved |= self.take(&found, accepted, id);
            }
        }
        moved
    }

    #[inline(always)]
    fn test_rays<const ANY: bool>(&mut self, leaf: &Leaf<'_>, mut rays: u32, class: Class) -> bool {
        let (axes, block) = (class.axes, leaf.block);
        let [a, b, c] = &block.corners;
        let corners = [rows_of(a, axes), rows_of(b, axes), rows_of(c, axes)];
        let mut moved = false;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize & (R::COUNT - 1);
            rays &= rays - 1;
            let aim = self.aim.spread(lane);
            let corners = aim.shear(&corners);
            let end = spread(&self.end, lane);
            let Sifted { possible, certain } = aim.sift::<ANY>(&corners, leaf.wanted, end);
            if ANY && certain != 0 && leaf.masks.is_none() {
                moved = true;
                self.stop(1 << lane);
                continue;
            }
            if possible == 0 {
                continue;
            }
            let found = R::Eight::hits(&corners, aim.direction_z, aim.t_min, end);
            let mut accepted = found.accepted & possible;
            while accepted != 0 {
                let i = accepted.trailing_zeros() as usize & (LANES - 1);
                accepted &= accepted - 1;
                let id = block.ids[i];
                if self.seeing(leaf.masks, id) >> lane & 1 == 0 {
                    continue;
                }
                if ANY {
                    moved = true;
                    self.stop(1 << lane);
                    break;
                }
                moved |= self.take_one(lane, [found.t.lane(i), found.u.lane(i), found.v.lane(i)], id);
            }
        }
        moved
    }

    /// The rays that see a triangle.
    #[inline(always)]
    fn seeing(&self, masks: Option<&[u32]>, id: u32) -> u32 {
        let Some(masks) = masks else { return all_lanes::<R>() };
        let mask = masks[id as usize];
        (0..R::COUNT).fold(0, |rays, lane| rays | u32::from(self.masks.lane(lane).to_bits() & mask != 0) << lane)
    }

    /// Rays that are done.
    #[inline(always)]
    fn stop(&mut self, rays: u32) {
        self.hit |= rays;
        self.end = R::mask(rays).select(R::splat(f32::NEG_INFINITY), self.end);
    }

    /// Keeps what is nearer than what is known, and what is as near and has a smaller id. Whether a ray ends earlier.
    #[inline(always)]
    fn take(&mut self, found: &Hits<R>, accepted: u32, id: u32) -> bool {
        let nearer = found.t.lt(self.end).signs();
        let mut wins = accepted & (nearer | !self.hit);
        let mut ties = accepted & !nearer & self.hit;
        while ties != 0 {
            let lane = ties.trailing_zeros();
            ties &= ties - 1;
            wins |= u32::from(id < self.tri.lane(lane as usize).to_bits()) << lane;
        }
        if wins == 0 {
            return false;
        }
        self.hit |= wins;
        let wins = R::mask(wins);
        self.end = wins.select(found.t, self.end);
        self.u = wins.select(found.u, self.u);
        self.v = wins.select(found.v, self.v);
        self.tri = wins.select(R::splat(f32::from_bits(id)), self.tri);
        self.aim.depths = Limits::new(self.t_min, self.end, self.aim.direction_z);
        true
    }

    /// [`Self::take`] for one ray.
    #[inline(always)]
    fn take_one(&mut self, lane: usize, [t, u, v]: [f32; 3], id: u32) -> bool {
        let (end, tri) = (self.end.lane(lane), self.tri.lane(lane).to_bits());
        if self.has_hit(lane) && !(t < end || (t == end && id < tri)) {
            return false;
        }
        self.hit |= 1 << lane;
        self.end.set_lane(lane, t);
        self.u.set_lane(lane, u);
        self.v.set_lane(lane, v);
        self.tri.set_lane(lane, f32::from_bits(id));
        self.aim.depths = Limits::new(self.t_min, self.end, self.aim.direction_z);
        true
    }
}

/// A triangle of a block, each coordinate in all lanes, along a frame's axes.
#[inline(always)]
fn corners_of<R: Floats>(block: &Block, lane: usize, axes: [usize; 3]) -> [[R; 3]; 3] {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = block.corners_along(lane, axes);
    [
        [R::splat(ax), R::splat(ay), R::splat(az)],
        [R::splat(bx), R::splat(by), R::splat(bz)],
        [R::splat(cx), R::splat(cy), R::splat(cz)],
    ]
}

/// A corner of all triangles of a block, along a frame's axes.
#[inline(always)]
fn rows_of<E: Eight>(corner: &[[f32; LANES]; 3], [kx, ky, kz]: [usize; 3]) -> [E; 3] {
    [E::load(&corner[kx.min(2)]), E::load(&corner[ky.min(2)]), E::load(&corner[kz.min(2)])]
}
