//! Instruction sets: algorithms are written once, against the narrow [`Kernels`]; an instruction set is one thin file.
//!
//! A [`Job`] is an algorithm that is compiled once for every level. [`Level::run`] enters the copy that the CPU can run; inside
//! it everything is inlined, so that a plain `cargo build --release` is as fast as one for this very CPU.
//!
//! Invariant: all levels give the same hits, bit for bit, and the same trees. Fused multiply-adds are used for box tests alone,
//! which are conservative whichever way they round; no approximate reciprocals.
#![allow(unsafe_code, reason = "intrinsics need it; each block says why it is sound")]

mod approach;
#[cfg(any(target_arch = "aarch64", test))]
mod arm;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx2_approach;
#[cfg(target_arch = "x86_64")]
mod avx2_boxes;
#[cfg(target_arch = "x86_64")]
mod avx2_eight;
#[cfg(target_arch = "x86_64")]
mod avx2_sight;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod avx512_sixteen;
mod block;
mod boxes;
mod eight;
mod floats;
mod four;
mod guess;
mod indices;
#[cfg(all(feature = "twin", target_arch = "x86_64"))]
mod leaky;
#[cfg(any(target_arch = "aarch64", test))]
mod neon;
mod portable;
mod prefetch;
mod reach;
mod sight;
#[cfg(test)]
mod two;

pub(crate) use approach::{Approach, Passing};
pub(crate) use block::{Block, LANES, Lanes};
pub(crate) use boxes::{BoxRay, Boxes};
pub(crate) use eight::Eight;
pub(crate) use floats::{Floats, Hits, all_lanes, extremes, highest, lowest, sheared, size};
pub(crate) use four::Four;
pub(crate) use guess::{apart, guessed_if, guessed_next};
pub(crate) use indices::Indices;
#[cfg(all(feature = "twin", target_arch = "x86_64"))]
pub(crate) use leaky::LeakyRay;
pub(crate) use portable::Portable;
pub(crate) use prefetch::prefetch;
pub(crate) use reach::reached_side_by_side;
pub(crate) use sight::{Aims, Corners, Entry, Met, Octet, RAYS, Shade, Sight, Views, step_of};
#[cfg(test)]
pub(crate) use two::Two;

use crate::geom::{Ray, RayFrame, Scale, Vec3};

/// A level of instructions that this CPU has: it can only be made by asking the CPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level(Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(any(target_arch = "aarch64", test))]
    Neon,
}

impl Level {
    /// What every CPU can run.
    pub const PORTABLE: Self = Self(Kind::Portable);

    /// The best level of this CPU.
    pub fn best() -> Self {
        Self::available().last().copied().unwrap_or(Self::PORTABLE)
    }

    /// All levels of this CPU, slowest first: tests run on each.
    pub fn available() -> Vec<Self> {
        #[cfg_attr(
            not(any(target_arch = "x86_64", target_arch = "aarch64", test)),
            expect(unused_mut, reason = "there is one level alone")
        )]
        let mut levels = vec![Self::PORTABLE];
        #[cfg(any(target_arch = "aarch64", test))]
        levels.push(Self(Kind::Neon));
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("bmi1")
            && std::arch::is_x86_feature_detected!("bmi2")
            && std::arch::is_x86_feature_detected!("lzcnt")
            && std::arch::is_x86_feature_detected!("popcnt")
            && std::arch::is_x86_feature_detected!("fma")
        {
            levels.push(Self(Kind::Avx2));
            if std::arch::is_x86_feature_detected!("avx512f")
                && std::arch::is_x86_feature_detected!("avx512vl")
                && std::arch::is_x86_feature_detected!("avx512dq")
                && std::arch::is_x86_feature_detected!("avx512bw")
            {
                levels.push(Self(Kind::Avx512));
            }
        }
        levels
    }

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "avx512",
            #[cfg(any(target_arch = "aarch64", test))]
            Kind::Neon => "neon",
        }
    }

    /// Runs a job, compiled for this level.
    #[inline(always)]
    pub(crate) fn run<J: Job>(self, job: J) -> J::Output {
        match self.0 {
            Kind::Portable => portable::enter(job),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Level` of this kind is only made where the CPU has AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
            Kind::Avx2 => unsafe { avx2::enter(job) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Level` of this kind is only made where the CPU has these, and AVX-512 F, VL, DQ and BW.
            Kind::Avx512 => unsafe { avx512::enter(job) },
            #[cfg(any(target_arch = "aarch64", test))]
            Kind::Neon => neon::enter(job),
        }
    }
}

/// An algorithm that is compiled for every level. `run` must be `#[inline(always)]`.
pub(crate) trait Job {
    /// What it yields.
    type Output;

    /// The algorithm.
    fn run<K: Kernels>(self) -> Self::Output;
}

/// A job that writes down what it yields: what is handed out is copied, which waits for its parts to be stored, ten cycles and more.
pub(crate) struct InPlace<'a, J: Job>(pub(crate) J, pub(crate) &'a mut J::Output);

impl<J: Job> Job for InPlace<'_, J> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        *self.1 = self.0.run::<K>();
    }
}

/// What a block's lanes have to do with a ray: a bit a lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sifted {
    /// THE triangle test might accept them. None is missing, a few may be too many.
    pub(crate) possible: u32,
    /// THE triangle test accepts them.
    pub(crate) certain: u32,
}

/// Where a ray enters boxes, lane by lane.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Entered<const W: usize>(pub(crate) [f32; W]);

/// What an instruction set must offer. Implementations are `#[inline(always)]`.
pub(crate) trait Kernels: Copy {
    /// Whether comparisons give masks.
    #[cfg(all(feature = "twin", target_arch = "x86_64"))]
    const MASKS: bool = false;

    /// A ray's frame, as blocks are looked at with it.
    type Frame: Copy;

    /// Eight triangles in a ray's frame.
    type Sheared: Copy;

    /// Prepares a valid ray.
    fn frame(ray: &Ray) -> Self::Frame;

    /// [`RayFrame::new`], bit for bit, of the ray that a frame was made from, with another interval of `t`.
    fn ray_frame(frame: &Self::Frame, interval: (f32, f32)) -> RayFrame;

    /// The direction's component along the frame's z.
    fn direction_z(frame: &Self::Frame) -> f32;

    /// Moves a block's triangles into the ray's frame, as THE triangle test does.
    fn shear(frame: &Self::Frame, block: &Block) -> Self::Sheared;

    /// Which of the `wanted` lanes the ray's line might pass through: none is missing, a few may be too many.
    fn inside(sheared: &Self::Sheared, wanted: u32) -> u32;

    /// Whether one of these lanes has a corner before the ray's start, so that the ray may have left it: an opinion.
    fn is_left(frame: &Self::Frame, sheared: &Self::Sheared, inside: u32, t_min: f32) -> bool;

    /// Which of these lanes THE triangle test might accept within an interval of `t`, and which it surely does.
    fn reached(frame: &Self::Frame, sheared: &Self::Sheared, inside: u32, interval: (f32, f32)) -> Sifted;

    /// The corners of the triangle in a lane.
    fn corners(sheared: &Self::Sheared, lane: usize) -> [Vec3; 3];

    /// Copies eight triangles out of a mesh's vertices.
    ///
    /// # Panics
    /// If a vertex is out of range.
    #[inline(always)]
    fn gather(points: &[Vec3], indices: &Indices, block: &mut Block) {
        indices.copy_to(points, block);
    }

    /// A ray, spread over the lanes of boxes.
    type BoxRay: Copy;

    /// [`BoxRay::new`], spread over the lanes; nothing if the ray is invalid.
    fn box_ray(ray: &Ray, scale: Scale, magnitude: f32) -> Option<Self::BoxRay>;

    /// Where the ray ends, in the boxes' `t`.
    fn end(ray: &Self::BoxRay) -> f32;

    /// Ends the ray at a hit, given in the ray's own `t`.
    fn end_at(ray: &mut Self::BoxRay, t: f32);

    /// Which of the boxes the ray meets: a bit a lane; `t` gets where it enters them. `W` is 2, 4 or 8.
    fn meet<const W: usize>(ray: &Self::BoxRay, boxes: &Boxes<W>, t: &mut Entered<W>) -> u32;

    /// Eight floats: a node's boxes, a block's triangles.
    type Eight: Eight;

    /// Floats of as many rays as go side by side in a packet.
    type Rays: Floats<Eight = Self::Eight>;

    /// Whether packets of rays pay: not where eight floats are a loop.
    const PACKETS: bool = true;

    /// For each plane, how many values lie strictly below it; `planes` and `counts` have one length, a multiple of 8.
    fn count_below(values: &[f32], planes: &[f32], counts: &mut [u32]);

    /// The same for values at or below the plane.
    fn count_up_to(values: &[f32], planes: &[f32], counts: &mut [u32]);

    /// For each plane, the weight of the values at or below it (`FROM`: at or above it). Summed in the values' order, on every
    /// level alike.
    fn weigh<const FROM: bool>(values: &[f32], weights: &[f32], planes: &[f32], sums: &mut [f32]);

    /// The smaller one of each lane, written to the first; lanes that hold no numbers mean nothing.
    fn lower(mine: &mut [f32; 8], theirs: &[f32; 8]);

    /// `(value − first) · scale` in each lane, rounded towards zero, 0 to `last`. Lanes 3 and 7 mean nothing.
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8];

    /// Which of eight octets of an eye's rays a triangle may be of interest to: a bit an octet.
    #[inline(always)]
    fn in_view(entry: &Entry, views: &Views) -> u32 {
        sight::in_view(entry, views)
    }

    /// Compares a triangle, given with its index, with eight rays from the eye; whether anything has changed.
    #[inline(always)]
    fn see(sight: &Sight, index: u32, octet: &mut Octet) -> bool {
        sight::see(sight, index, octet)
    }

    /// Which of eight rays towards the eye a triangle may stop, were they to end at the eye, and which it surely does,
    /// whatever its mask.
    #[inline(always)]
    fn shade(sight: &Sight, rays: &Shade) -> Sifted {
        sight::shade(sight, rays)
    }

    /// Makes eight rays ready that end at the eye, and tells the side of the eye that each comes from; all others are strays, and done.
    #[inline(always)]
    fn approach(rays: &[Ray; RAYS], passing: &Passing, shade: &mut Shade) -> [u32; RAYS] {
        approach::approach(rays, passing, shade)
    }

    /// Makes eight rays ready that start at the eye, bit for bit; all others are strays.
    #[inline(always)]
    fn aim(rays: &[&Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
        sight::aim(rays, eye, aims);
    }

    /// THE triangle test, bit for bit, of eight rays from the eye, each with a triangle of its own. The eye is given along the axes of
    /// the rays' side, as the corners are.
    #[inline(always)]
    fn meet_own(aims: &Aims, eye: &Vec3, corners: &[&Corners; RAYS], met: &mut Met) {
        sight::meet_own(aims, eye, corners, met);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Aabb, TriId, hit_sheared, hit_triangle};

    /// Everything that kernels compute, for one set of inputs.
    struct Everything<'a> {
        block: &'a Block,
        ray: &'a Ray,
        values: &'a [f32],
    }

    /// Lanes of a block: those that the line may pass through, and of these those that may be hit, those that THE triangle test
    /// accepts, those that surely are.
    #[derive(Debug, Clone, Copy)]
    struct Lanes {
        inside: u32,
        possible: u32,
        accepted: u32,
        certain: u32,
    }

    impl Lanes {
        fn of<K: Kernels>(ray: &Ray, block: &Block, (t_min, t_max): (f32, f32)) -> Self {
            let lanes = K::frame(ray);
            let frame = K::ray_frame(&lanes, (t_min, t_max));
            assert_eq!(frame, RayFrame { t_min, t_max, ..RayFrame::new(ray) });
            assert_eq!(K::direction_z(&lanes), frame.direction_z);
            let sheared = K::shear(&lanes, block);
            let inside = K::inside(&sheared, 0xff);
            let Sifted { possible, certain } = K::reached(&lanes, &sheared, inside, (t_min, t_max));
            let mut accepted = 0;
            for i in 0..LANES {
                let hit = hit_triangle(&frame, &block.corners(i), TriId(0));
                accepted |= u32::from(hit.is_some()) << i;
                let same = hit_sheared(&K::corners(&sheared, i), frame.direction_z, (t_min, t_max), TriId(0));
                assert_eq!(same, hit, "the same corners in the ray's frame");
            }
            let by_eight = by_eight::<K::Eight>(&sheared_corners::<K>(&sheared), frame.direction_z, (t_min, t_max));
            assert_eq!(by_eight.certain & inside & !accepted, 0, "what is certain by eight is accepted");
            assert_eq!(accepted & !by_eight.possible, 0, "what is accepted is possible by eight");
            Self { inside, possible, accepted, certain }
        }

        fn check(self, what: &str) {
            assert_eq!(self.certain & !self.accepted, 0, "{what}: what is certain is accepted");
            assert_eq!(self.accepted & !self.possible, 0, "{what}: what is accepted is possible");
            assert_eq!(self.possible & !self.inside, 0, "{what}: what is possible is inside");
        }
    }

    /// `corners[corner][axis][lane]`, in the ray's frame.
    fn sheared_corners<K: Kernels>(sheared: &K::Sheared) -> [[[f32; LANES]; 3]; 3] {
        let all: [[Vec3; 3]; LANES] = std::array::from_fn(|lane| K::corners(sheared, lane));
        [0, 1, 2].map(|c| [0, 1, 2].map(|a| std::array::from_fn(|lane| all[lane][c][a])))
    }

    fn by_eight<E: Eight>(corners: &[[[f32; LANES]; 3]; 3], direction_z: f32, (t_min, t_max): (f32, f32)) -> Sifted {
        let corners = corners.each_ref().map(|corner| corner.each_ref().map(E::load));
        let cross = |a: &[E; 3], b: &[E; 3]| a[0].mul(b[1]).sub(a[1].mul(b[0]));
        let [a, b, c] = &corners;
        let w @ [u, v, last] = [cross(c, b), cross(a, c), cross(b, a)];
        let extremes = (u.min(v).min(last), u.max(v).max(last));
        reached_side_by_side(&w, extremes, &corners, E::splat(direction_z), (E::splat(t_min), E::splat(t_max)))
    }

    impl Job for Everything<'_> {
        type Output = (Lanes, (u32, Vec<u32>, Vec<u32>, Vec<f32>, [i32; 8]));

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            let lanes = Lanes::of::<K>(self.ray, self.block, (self.ray.t_min, self.ray.t_max));
            let planes = &self.values[..16];
            let (mut below, mut up_to, mut sums) = (vec![0; 16], vec![0; 16], vec![0.0; 13]);
            K::count_below(self.values, planes, &mut below);
            K::count_up_to(self.values, planes, &mut up_to);
            K::weigh::<true>(self.values, &self.values[3..], &planes[..13], &mut sums);
            let mut row = [0.0; 8];
            row.copy_from_slice(&self.values[..8]);
            let mut bins = K::bin(&row, &[-1.0; 8], &[3.7; 8], 5);
            (bins[3], bins[7]) = (0, 0);
            (lanes, (lanes.inside, below, up_to, sums, bins))
        }
    }

    /// Coarse numbers: they meet in exact zeros and ties often.
    fn coarse() -> impl FnMut() -> f32 {
        let mut state = 7u32;
        move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            f32::from((state >> 28) as u8) / 4.0 - 2.0
        }
    }

    fn random_block(random: &mut impl FnMut() -> f32) -> Block {
        let mut block: Block = bytemuck::Zeroable::zeroed();
        for lane in 0..LANES {
            let mut point = || [random(), random(), random()];
            block.set(lane, &[point(), point(), point()], 0);
        }
        block
    }

    #[test]
    fn all_levels_give_the_same_bits() {
        let mut random = coarse();
        for _ in 0..20_000 {
            let block = random_block(&mut random);
            let ray = Ray::new([random(), random(), random()], [random() + 0.01, random(), random()]);
            let ray = if random() > 0.0 { ray.within(0.0, 0.5) } else { ray };
            let values: Vec<f32> = (0..40).map(|_| random()).collect();
            let on = |level: Level| level.run(Everything { block: &block, ray: &ray, values: &values });
            let (_, portable) = on(Level::PORTABLE);
            for level in Level::available() {
                let (lanes, same) = on(level);
                assert_eq!(same, portable, "{}", level.name());
                lanes.check(level.name());
            }
        }
    }

    /// Sifting of any block, by any ray, for an interval.
    struct Sift<'a>(&'a Block, &'a Ray, (f32, f32));

    impl Job for Sift<'_> {
        type Output = Lanes;

        #[inline(always)]
        fn run<K: Kernels>(self) -> Lanes {
            Lanes::of::<K>(self.1, self.0, self.2)
        }
    }

    /// At every size that numbers can have, the ends of the interval being just where triangles are crossed.
    #[test]
    fn what_is_sifted_out_is_no_hit_and_what_is_certain_is_one() {
        let (mut random, mut possible, mut certain, mut inside, mut accepted) = (coarse(), 0, 0, 0, 0);
        let power = |exponent: i32| 2f64.powi(exponent) as f32;
        for round in 0..5_000 {
            let size = power(round % 250 - 125);
            let block = random_block(&mut || random() * size);
            let long = power(round / 7 % 250 - 125);
            let origin = [random() * size, random() * size, random() * size];
            let ray = Ray::new(origin, [random() * long, random() * long, (random() + 0.01) * long]);
            if !ray.is_valid() {
                continue;
            }
            let crossed = (0..LANES).find_map(|i| {
                let whole = RayFrame::new(&ray.within(f32::NEG_INFINITY, f32::INFINITY));
                hit_triangle(&whole, &block.corners(i), TriId(0))
            });
            let t = crossed.map_or(0.0, |hit| hit.t);
            let ends = [t, t.next_up(), t.next_down(), 0.0, f32::INFINITY, f32::NEG_INFINITY, 2.0 * t];
            for (t_min, t_max) in ends.iter().flat_map(|&a| ends.map(|b| (a, b))).filter(|(a, b)| a <= b) {
                for level in Level::available() {
                    let lanes = level.run(Sift(&block, &ray, (t_min, t_max)));
                    lanes.check(level.name());
                    if round % 250 == 125 {
                        inside += lanes.inside.count_ones();
                        possible += lanes.possible.count_ones();
                        accepted += lanes.accepted.count_ones();
                        certain += lanes.certain.count_ones();
                    }
                }
            }
        }
        // At ordinary sizes little is left to be tested.
        assert!(
            accepted > 100 && possible < accepted + inside / 4 && certain > accepted / 4,
            "{possible} {accepted} {certain}"
        );
    }

    /// The boxes that a ray meets before and after it is shortened, and where it enters those.
    struct Meeting<'a, const W: usize>(&'a Ray, &'a Boxes<W>);

    impl<const W: usize> Job for Meeting<'_, W> {
        type Output = (u32, u32, [u32; W]);

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            let mut ray = K::box_ray(self.0, Scale::of(&Aabb::EMPTY), 2.0).expect("a valid ray");
            let mut t = Entered([0.0; W]);
            let before = K::meet(&ray, self.1, &mut t);
            K::end_at(&mut ray, 1.0);
            let after = K::meet(&ray, self.1, &mut t);
            (before, after, std::array::from_fn(|i| if after >> i & 1 == 1 { t.0[i].to_bits() } else { 0 }))
        }
    }

    fn boxes_are_met_alike<const W: usize>() {
        let (mut random, mut met) = (coarse(), 0);
        for _ in 0..10_000 {
            let mut boxes = Boxes::<W>::NONE;
            for lane in 0..W {
                let (a, b) = ([random(), random(), random()], [random(), random(), random()]);
                let bounds = Aabb { min: [0, 1, 2].map(|i| a[i].min(b[i])), max: [0, 1, 2].map(|i| a[i].max(b[i])) };
                // Some lanes stay without a box.
                if random() > -1.5 {
                    boxes.set(lane, &bounds, 0);
                }
            }
            // Powers of two, and zeros: products are exact, so that fused multiply-adds round like separate ones.
            const SLOPES: [f32; 8] = [0.0, -0.0, 0.5, 1.0, 2.0, -0.5, -1.0, -2.0];
            let mut slope = || SLOPES[((random() + 2.0) * 2.0) as usize];
            let direction = [slope(), slope(), 1.0];
            let ray = Ray::new([random(), random(), random()], direction);
            let portable = Level::PORTABLE.run(Meeting(&ray, &boxes));
            for level in Level::available() {
                assert_eq!(level.run(Meeting(&ray, &boxes)), portable, "{}: {ray:?}", level.name());
            }
            met += portable.1.count_ones();
        }
        assert!(met > 1_000, "{met}");
    }

    #[test]
    fn all_levels_meet_the_same_boxes() {
        boxes_are_met_alike::<2>();
        boxes_are_met_alike::<4>();
        boxes_are_met_alike::<8>();
    }

    #[test]
    fn all_levels_lower_alike() {
        struct Lower([f32; 8], [f32; 8]);
        impl Job for Lower {
            type Output = [f32; 8];

            #[inline(always)]
            fn run<K: Kernels>(mut self) -> [f32; 8] {
                K::lower(&mut self.0, &self.1);
                self.0
            }
        }
        let (mine, theirs) =
            ([1.0, 2.0, -3.0, 4.0, 5.0, 6.0, f32::INFINITY, 8.0], [2.0, 1.0, -2.0, -4.0, 5.5, 0.0, 3.0, 9.0]);
        for level in Level::available() {
            assert_eq!(level.run(Lower(mine, theirs)), [1.0, 1.0, -3.0, -4.0, 5.0, 0.0, 3.0, 8.0], "{}", level.name());
        }
    }
}
