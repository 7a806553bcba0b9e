//! Instruction sets: algorithms are written once, against the narrow [`Kernels`]; an instruction set is one thin file.
//!
//! A [`Job`] is an algorithm that is compiled once for every level. [`Level::run`] enters the copy that the CPU can run; inside
//! it everything is inlined, so that a plain `cargo build --release` is as fast as one for this very CPU.
//!
//! Invariant: all levels give the same hits, bit for bit, and the same trees. Fused multiply-adds are used for box tests alone,
//! which are conservative whichever way they round; no approximate reciprocals.
#![allow(unsafe_code, reason = "intrinsics need it; each block says why it is sound")]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx2_boxes;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod block;
mod boxes;
mod four;
mod guess;
mod indices;
#[cfg(all(feature = "twin", target_arch = "x86_64"))]
mod leaky;
mod portable;

pub(crate) use block::{Block, LANES, Lanes};
pub(crate) use boxes::{BoxRay, Boxes};
pub(crate) use four::Four;
pub(crate) use guess::guessed;
pub(crate) use indices::Indices;
#[cfg(all(feature = "twin", target_arch = "x86_64"))]
pub(crate) use leaky::LeakyRay;
pub(crate) use portable::Portable;

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
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut, reason = "there is one level alone"))]
        let mut levels = vec![Self::PORTABLE];
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
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything that kernels compute, for one set of inputs.
    struct Everything<'a> {
        block: &'a Block,
        ray: &'a Ray,
        values: &'a [f32],
    }

    impl Job for Everything<'_> {
        type Output = (u32, u32, Vec<u32>, Vec<u32>, Vec<f32>, [i32; 8]);

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            let (frame, mut lanes) = K::frames(self.ray);
            let before = K::sift::<true>(&lanes, self.block, 0xff);
            K::shorten(&mut lanes, &RayFrame { t_max: 0.5, ..frame });
            let after = K::sift::<true>(&lanes, self.block, 0xff);
            let planes = &self.values[..16];
            let (mut below, mut up_to, mut sums) = (vec![0; 16], vec![0; 16], vec![0.0; 13]);
            K::count_below(self.values, planes, &mut below);
            K::count_up_to(self.values, planes, &mut up_to);
            K::weigh::<true>(self.values, &self.values[3..], &planes[..13], &mut sums);
            let mut row = [0.0; 8];
            row.copy_from_slice(&self.values[..8]);
            let mut bins = K::bin(&row, &[-1.0; 8], &[3.7; 8], 5);
            (bins[3], bins[7]) = (0, 0);
            (before.possible | after.possible << 8, before.certain | after.certain << 8, below, up_to, sums, bins)
        }
    }

    #[test]
    fn all_levels_give_the_same_bits() {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            // Coarse numbers meet in exact zeros and ties often.
            f32::from((state >> 28) as u8) / 4.0 - 2.0
        };
        let (mut possible, mut certain) = (0, 0);
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
            let portable = on(Level::PORTABLE);
            for level in Level::available() {
                assert_eq!(on(level), portable, "{}", level.name());
            }
            assert_eq!(portable.1 & !portable.0, 0, "what is certain is possible");
            possible += portable.0.count_ones();
            certain += portable.1.count_ones();
        }
        assert!(certain > 100 && possible > certain, "{certain} of {possible}");
    }
}
