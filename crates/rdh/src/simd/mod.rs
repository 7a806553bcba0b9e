//! Instruction sets: algorithms are written once, against the narrow [`Kernels`]; an instruction set is one thin file.
//!
//! A [`Job`] is an algorithm that is compiled once for every level. [`Level::run`] enters the copy that the CPU can run; inside
//! it everything is inlined, so that a plain `cargo build --release` is as fast as one for this very CPU.
//!
//! Invariant: all levels give the same hits, bit for bit, and the same trees. Fused multiply-adds are used for box tests alone,
//! which are conservative whichever way they round; no approximate reciprocals.
#![allow(unsafe_code, reason = "intrinsics need it; each block says why it is sound")]

#[cfg(any(target_arch = "aarch64", test))]
mod arm;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx2_boxes;
#[cfg(target_arch = "x86_64")]
mod avx2_sight;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod block;
mod boxes;
mod four;
mod guess;
mod indices;
#[cfg(all(feature = "twin", target_arch = "x86_64"))]
mod leaky;
#[cfg(any(target_arch = "aarch64", test))]
mod neon;
mod portable;
mod sight;

pub(crate) use block::{Block, LANES, Lanes};
pub(crate) use boxes::{BoxRay, Boxes};
pub(crate) use four::Four;
pub(crate) use guess::guessed;
pub(crate) use indices::Indices;
#[cfg(all(feature = "twin", target_arch = "x86_64"))]
pub(crate) use leaky::LeakyRay;
pub(crate) use portable::Portable;
pub(crate) use sight::{Aims, Corners, Entry, Met, Octet, RAYS, Shade, Sight, Views, step_of};

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
            // SAFETY: a `Level` of this kind is only made where the CPU has AVX2, FMA, BMI1 and BMI2.
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

    /// A ray's frame, spread over the lanes.
    type Frame: Copy;

    /// [`RayFrame::new`], bit for bit, and the same spread over the lanes.
    fn frames(ray: &Ray) -> (RayFrame, Self::Frame);

    /// Takes over a shortened interval of `t`.
    fn shorten(lanes: &mut Self::Frame, frame: &RayFrame);

    /// Which of the `wanted` lanes THE triangle test might accept, and, if it matters (`CERTAIN`), which it surely does.
    fn sift<const CERTAIN: bool>(frame: &Self::Frame, block: &Block, wanted: u32) -> Sifted;

    /// The corners of the triangle in a lane of a block, along the frame's axes.
    fn corners(ray: &RayFrame, frame: &Self::Frame, block: &Block, lane: usize) -> [Vec3; 3];

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

    /// Makes eight rays ready that start at the eye, bit for bit; all others are strays.
    #[inline(always)]
    fn aim(rays: &[Ray; RAYS], eye: &Vec3, aims: &mut Aims) {
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
    use crate::geom::{Aabb, TriId, hit_triangle};

    /// Everything that kernels compute, for one set of inputs.
    struct Everything<'a> {
        block: &'a Block,
        ray: &'a Ray,
        values: &'a [f32],
    }

    /// Lanes of a block, before and after the ray is shortened: those that are possible, those that THE triangle test accepts,
    /// those that are certain.
    #[derive(Debug, Clone, Copy)]
    struct Lanes {
        possible: u32,
        accepted: u32,
        certain: u32,
    }

    /// The lanes of a block that THE triangle test accepts.
    fn accepted(frame: &RayFrame, block: &Block) -> u32 {
        let hit = |i: usize| hit_triangle(frame, &block.corners(i), TriId(0)).is_some();
        (0..LANES).fold(0, |lanes, i| lanes | u32::from(hit(i)) << i)
    }

    impl Job for Everything<'_> {
        type Output = (Lanes, (Vec<u32>, Vec<u32>, Vec<f32>, [i32; 8]));

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            let (frame, mut lanes) = K::frames(self.ray);
            let before = K::sift::<true>(&lanes, self.block, 0xff);
            let shortened = RayFrame { t_max: 0.5, ..frame };
            K::shorten(&mut lanes, &shortened);
            let after = K::sift::<true>(&lanes, self.block, 0xff);
            assert_eq!(K::sift::<false>(&lanes, self.block, 0xff).possible, after.possible);
            let lanes = Lanes {
                possible: before.possible | after.possible << 8,
                accepted: accepted(&frame, self.block) | accepted(&shortened, self.block) << 8,
                certain: before.certain | after.certain << 8,
            };
            let planes = &self.values[..16];
            let (mut below, mut up_to, mut sums) = (vec![0; 16], vec![0; 16], vec![0.0; 13]);
            K::count_below(self.values, planes, &mut below);
            K::count_up_to(self.values, planes, &mut up_to);
            K::weigh::<true>(self.values, &self.values[3..], &planes[..13], &mut sums);
            let mut row = [0.0; 8];
            row.copy_from_slice(&self.values[..8]);
            let mut bins = K::bin(&row, &[-1.0; 8], &[3.7; 8], 5);
            (bins[3], bins[7]) = (0, 0);
            (lanes, (below, up_to, sums, bins))
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

    #[test]
    fn all_levels_give_the_same_bits() {
        let mut random = coarse();
        let (mut possible, mut spared, mut certain) = (0, 0, 0);
        for _ in 0..20_000 {
            let mut block: Block = bytemuck::Zeroable::zeroed();
            for lane in 0..LANES {
                block.set(
                    lane,
                    &[[random(), random(), random()], [random(), random(), random()], [random(), random(), random()]],
                    0,
                );
            }
            let ray = Ray::new([random(), random(), random()], [random() + 0.01, random(), random()]);
            let values: Vec<f32> = (0..40).map(|_| random()).collect();
            let on = |level: Level| level.run(Everything { block: &block, ray: &ray, values: &values });
            let (portable, others) = on(Level::PORTABLE);
            for level in Level::available() {
                let (lanes, same) = on(level);
                assert_eq!((lanes.certain, &same), (portable.certain, &others), "{}", level.name());
                assert_eq!(lanes.certain & !lanes.accepted, 0, "{}: what is certain is accepted", level.name());
                assert_eq!(lanes.accepted & !lanes.possible, 0, "{}: what is accepted is possible", level.name());
                // Some levels look closer than plain loops.
                assert_eq!(lanes.possible & !portable.possible, 0, "{}", level.name());
                spared += (portable.possible & !lanes.possible).count_ones();
            }
            possible += portable.possible.count_ones();
            certain += portable.certain.count_ones();
        }
        assert!(certain > 100 && possible > certain, "{certain} of {possible}");
        let looks_closer = Level::available().iter().any(|level| level.name().starts_with("avx"));
        assert_eq!(spared > 1_000, looks_closer, "{spared} of {possible}");
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
