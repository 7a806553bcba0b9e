//! NEON's instructions under their own names, safe to call: every CPU of the target has them.
//!
//! On other machines, where only tests use them, each is a line of plain Rust; so `neon.rs` is tested everywhere.

#[cfg(target_arch = "aarch64")]
pub(crate) use std::arch::aarch64::{float32x4_t as F32, int32x4_t as I32, uint32x4_t as U32};

#[cfg(not(target_arch = "aarch64"))]
pub(crate) use model::{F32, I32, U32};
#[cfg(not(target_arch = "aarch64"))]
use model::{all_bits, each, number, pair};

macro_rules! instructions {
    ($($name:ident($($argument:ident: $type:ty),*) -> $output:ty = $model:expr;)*) => {$(
        #[inline(always)]
        pub(super) fn $name($($argument: $type),*) -> $output {
            #[cfg(not(target_arch = "aarch64"))]
            return $model;
            // SAFETY: the target has NEON.
            #[cfg(target_arch = "aarch64")]
            unsafe { std::arch::aarch64::$name($($argument),*) }
        }
    )*};
}

instructions! {
    vdupq_n_f32(x: f32) -> F32 = [x; 4];
    vdupq_n_u32(x: u32) -> U32 = [x; 4];
    vdupq_n_s32(x: i32) -> I32 = [x; 4];
    vaddq_f32(a: F32, b: F32) -> F32 = pair(a, b, |a, b| a + b);
    vsubq_f32(a: F32, b: F32) -> F32 = pair(a, b, |a, b| a - b);
    vmulq_f32(a: F32, b: F32) -> F32 = pair(a, b, |a, b| a * b);
    vfmaq_f32(a: F32, b: F32, c: F32) -> F32 = std::array::from_fn(|i| b[i].mul_add(c[i], a[i]));
    vminq_f32(a: F32, b: F32) -> F32 = pair(a, b, |a, b| number(a, b, a.min(b)));
    vmaxq_f32(a: F32, b: F32) -> F32 = pair(a, b, |a, b| number(a, b, a.max(b)));
    vcltq_f32(a: F32, b: F32) -> U32 = pair(a, b, |a, b| all_bits(a < b));
    vcleq_f32(a: F32, b: F32) -> U32 = pair(a, b, |a, b| all_bits(a <= b));
    vcgeq_f32(a: F32, b: F32) -> U32 = pair(a, b, |a, b| all_bits(a >= b));
    vcltzq_f32(a: F32) -> U32 = each(a, |a| all_bits(a < 0.0));
    vcgtzq_f32(a: F32) -> U32 = each(a, |a| all_bits(a > 0.0));
    vandq_u32(a: U32, b: U32) -> U32 = pair(a, b, |a, b| a & b);
    vorrq_u32(a: U32, b: U32) -> U32 = pair(a, b, |a, b| a | b);
    vsubq_u32(a: U32, b: U32) -> U32 = pair(a, b, u32::wrapping_sub);
    vaddvq_u32(a: U32) -> u32 = a.into_iter().fold(0, u32::wrapping_add);
    vreinterpretq_u32_f32(a: F32) -> U32 = each(a, f32::to_bits);
    vreinterpretq_f32_u32(a: U32) -> F32 = each(a, f32::from_bits);
    vcvtq_s32_f32(a: F32) -> I32 = each(a, |a| a as i32);
    vminq_s32(a: I32, b: I32) -> I32 = pair(a, b, i32::min);
    vmaxq_s32(a: I32, b: I32) -> I32 = pair(a, b, i32::max);
}

/// Four numbers.
#[inline(always)]
pub(super) fn load(from: &[f32; 4]) -> F32 {
    // SAFETY: registers are four numbers side by side, without padding, and any bits are numbers.
    unsafe { std::ptr::from_ref(from).cast::<F32>().read_unaligned() }
}

/// Four numbers.
#[inline(always)]
pub(super) fn load_u32(from: &[u32; 4]) -> U32 {
    // SAFETY: as in `load`.
    unsafe { std::ptr::from_ref(from).cast::<U32>().read_unaligned() }
}

/// The numbers of a register.
#[inline(always)]
pub(super) fn numbers(register: F32) -> [f32; 4] {
    // SAFETY: as in `load`.
    unsafe { std::mem::transmute_copy(&register) }
}

/// The numbers of a register.
#[inline(always)]
pub(super) fn numbers_u32(register: U32) -> [u32; 4] {
    // SAFETY: as in `load`.
    unsafe { std::mem::transmute_copy(&register) }
}

/// The numbers of a register.
#[inline(always)]
pub(super) fn numbers_i32(register: I32) -> [i32; 4] {
    // SAFETY: as in `load`.
    unsafe { std::mem::transmute_copy(&register) }
}

#[cfg(not(target_arch = "aarch64"))]
mod model {
    pub(crate) type F32 = [f32; 4];
    pub(crate) type I32 = [i32; 4];
    pub(crate) type U32 = [u32; 4];

    pub(super) fn each<T, O>(a: [T; 4], of: impl Fn(T) -> O) -> [O; 4] {
        a.map(of)
    }

    pub(super) fn pair<T: Copy, O>(a: [T; 4], b: [T; 4], of: impl Fn(T, T) -> O) -> [O; 4] {
        std::array::from_fn(|i| of(a[i], b[i]))
    }

    pub(super) fn all_bits(holds: bool) -> u32 {
        if holds { u32::MAX } else { 0 }
    }

    /// Something that is not a number has no smaller and no larger one.
    pub(super) fn number(a: f32, b: f32, of_numbers: f32) -> f32 {
        if a.is_nan() || b.is_nan() { f32::NAN } else { of_numbers }
    }
}
