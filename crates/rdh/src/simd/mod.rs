//! Instruction sets: algorithms are written once, against the narrow [`Kernels`]; an instruction set is one thin file.
//!
//! A [`Job`] is an algorithm that is compiled once for every level. [`Level::run`] enters the copy that the CPU can run; inside
//! it everything is inlined, so that a plain `cargo build --release` is as fast as one for this very CPU.
//!
//! Invariant: all levels give the same bits. No fused multiply-add, no approximate reciprocal.
#![allow(unsafe_code, reason = "intrinsics need it; each block says why it is sound")]

#[cfg(target_arch = "x86_64")]
mod avx2;
mod block;
mod portable;

pub(crate) use block::{Block, LANES};

use crate::geom::RayFrame;

/// A level of instructions that this CPU has: it can only be made by asking the CPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level(Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
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
        let mut levels = vec![Self::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("bmi1")
            && std::arch::is_x86_feature_detected!("bmi2")
        {
            levels.push(Self(Kind::Avx2));
        }
        levels
    }

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
        }
    }

    /// Runs a job, compiled for this level.
    #[inline(always)]
    pub(crate) fn run<J: Job>(self, job: J) -> J::Output {
        match self.0 {
            Kind::Portable => job.run::<portable::Portable>(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Level` of this kind is only made where the CPU has AVX2, BMI1 and BMI2.
            Kind::Avx2 => unsafe { avx2::enter(job) },
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

/// What an instruction set must offer. Implementations are `#[inline(always)]`.
pub(crate) trait Kernels: Copy {
    /// A ray's frame, spread over the lanes.
    type Frame: Copy;

    /// Spreads a frame over the lanes.
    fn frame(frame: &RayFrame) -> Self::Frame;

    /// Takes over a shortened interval of `t`.
    fn shorten(lanes: &mut Self::Frame, frame: &RayFrame);

    /// Which lanes THE triangle test might accept, and which it surely does.
    fn sift(frame: &Self::Frame, block: &Block) -> Sifted;

    /// For each plane, how many values lie strictly below it; `planes` and `counts` have one length, a multiple of 8.
    fn count_below(values: &[f32], planes: &[f32], counts: &mut [u32]);

    /// The same for values at or below the plane.
    fn count_up_to(values: &[f32], planes: &[f32], counts: &mut [u32]);

    /// For each plane, the weight of the values at or below it (`FROM`: at or above it). Summed in the values' order, on every
    /// level alike.
    fn weigh<const FROM: bool>(values: &[f32], weights: &[f32], planes: &[f32], sums: &mut [f32]);

    /// `(value − first) · scale` in each lane, rounded towards zero, 0 to `last`. Lanes 3 and 7 mean nothing.
    fn bin(values: &[f32; 8], first: &[f32; 8], scale: &[f32; 8], last: i32) -> [i32; 8];
}
