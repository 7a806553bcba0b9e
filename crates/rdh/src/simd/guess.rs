//! Masks and indices as the outcome of jumps, which the CPU guesses, instead of data, which it waits for.
//!
//! The way from a node to its child is a chain: fetch planes, multiply, compare, find the lane, fetch the link, about 40 cycles in
//! which little else happens. Where the mask of the boxes that were met comes out of a jump, the CPU guesses it from what came
//! before and fetches the child meanwhile; the chain only confirms. Coherent rays are a fifth faster for it, shadows a third, and even
//! bounces gain: once the jump has gone right, all that follows from the mask is guessed right too.

/// The same eight bits, by way of a jump to one of 256 places.
///
/// A constant of plain Rust would be merged back into the data that it came from; hence the assembly in `constant`.
#[inline(always)]
fn guessed(mask: u32) -> u32 {
    macro_rules! jump {
        ($($mask:literal)*) => {
            match mask as u8 {
                $($mask => constant::<$mask>(),)*
                255 => constant::<255>(),
            }
        };
    }
    jump! {
        0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
        16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31
        32 33 34 35 36 37 38 39 40 41 42 43 44 45 46 47
        48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63
        64 65 66 67 68 69 70 71 72 73 74 75 76 77 78 79
        80 81 82 83 84 85 86 87 88 89 90 91 92 93 94 95
        96 97 98 99 100 101 102 103 104 105 106 107 108 109 110 111
        112 113 114 115 116 117 118 119 120 121 122 123 124 125 126 127
        128 129 130 131 132 133 134 135 136 137 138 139 140 141 142 143
        144 145 146 147 148 149 150 151 152 153 154 155 156 157 158 159
        160 161 162 163 164 165 166 167 168 169 170 171 172 173 174 175
        176 177 178 179 180 181 182 183 184 185 186 187 188 189 190 191
        192 193 194 195 196 197 198 199 200 201 202 203 204 205 206 207
        208 209 210 211 212 213 214 215 216 217 218 219 220 221 222 223
        224 225 226 227 228 229 230 231 232 233 234 235 236 237 238 239
        240 241 242 243 244 245 246 247 248 249 250 251 252 253 254
    }
}

/// [`guessed`] where it is worth the 3 KiB that its jump takes: in the walk that users run through nodes of eight.
#[inline(always)]
pub(crate) fn guessed_if<const W: usize>(mask: u32, matters: bool) -> u32 {
    if W == 8 && matters { guessed(mask) } else { mask }
}

/// `next`; where it comes right after `last`, by way of a branch: the CPU guesses that it does, adds 1 to what it knows, and need not
/// wait for `next`.
#[inline(always)]
pub(crate) fn guessed_next(last: u32, next: u32) -> u32 {
    if next.wrapping_sub(last) == 1 { after(last) } else { next }
}

/// Ways through the code with different numbers stay apart: the compiler doesn't merge them again, and the CPU guesses at each what
/// happens there.
#[inline(always)]
pub(crate) fn apart<const WAY: u32>() {
    #[cfg(all(any(target_arch = "x86_64", target_arch = "aarch64"), not(miri)))]
    // SAFETY: a comment does nothing.
    unsafe {
        std::arch::asm!("/* {0} */", const WAY, options(nomem, nostack, preserves_flags));
    }
}

/// One more, wrapping, as the compiler can't see: it would take the number that this is known to be equal to.
#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline(always)]
fn after(x: u32) -> u32 {
    let more: u32;
    // SAFETY: it adds 1 to a register and touches nothing else.
    unsafe {
        std::arch::asm!("lea {0:e}, [{1:r} + 1]", out(reg) more, in(reg) x, options(pure, nomem, nostack, preserves_flags));
    }
    more
}

/// One more, wrapping, as the compiler can't see: it would take the number that this is known to be equal to.
#[cfg(all(target_arch = "aarch64", not(miri)))]
#[inline(always)]
fn after(x: u32) -> u32 {
    let more: u32;
    // SAFETY: it adds 1 to a register and touches nothing else.
    unsafe {
        std::arch::asm!("add {0:w}, {1:w}, #1", out(reg) more, in(reg) x, options(pure, nomem, nostack, preserves_flags));
    }
    more
}

/// Elsewhere, and under Miri, which knows no assembly, the compiler may see it.
#[cfg(any(miri, not(any(target_arch = "x86_64", target_arch = "aarch64"))))]
#[inline(always)]
fn after(x: u32) -> u32 {
    x.wrapping_add(1)
}

/// A constant that the compiler can't see through.
#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline(always)]
fn constant<const MASK: u32>() -> u32 {
    let mask: u32;
    // SAFETY: it sets a register and touches nothing else.
    unsafe {
        std::arch::asm!("mov {0:e}, {1}", out(reg) mask, const MASK, options(pure, nomem, nostack, preserves_flags));
    }
    mask
}

/// A constant that the compiler can't see through.
#[cfg(all(target_arch = "aarch64", not(miri)))]
#[inline(always)]
fn constant<const MASK: u32>() -> u32 {
    let mask: u32;
    // SAFETY: it sets a register and touches nothing else.
    unsafe {
        std::arch::asm!("mov {0:w}, #{1}", out(reg) mask, const MASK, options(pure, nomem, nostack, preserves_flags));
    }
    mask
}

/// Elsewhere, and under Miri, the mask stays what it is.
#[cfg(any(miri, not(any(target_arch = "x86_64", target_arch = "aarch64"))))]
#[inline(always)]
fn constant<const MASK: u32>() -> u32 {
    MASK
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guess_changes_nothing() {
        (0..256).for_each(|mask| assert_eq!(guessed(std::hint::black_box(mask)), mask));
        for last in [0, 1, 7, u32::MAX - 1, u32::MAX] {
            for next in [last, last.wrapping_add(1), last.wrapping_add(2), 0, 3] {
                assert_eq!(guessed_next(std::hint::black_box(last), std::hint::black_box(next)), next);
            }
        }
    }
}
