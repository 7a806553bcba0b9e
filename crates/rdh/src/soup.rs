//! Triangles and numbers for unit tests.

use crate::Mesh;

/// Steps of a generator, in [-1, 1).
pub(crate) fn numbers(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}

/// Triangles anywhere, of all sizes up to the `largest`, about.
pub(crate) fn soup(n: u32, largest: f32) -> Mesh {
    let mut x = numbers(n);
    let mut corners = |_| {
        let (centre, size) = ([x(), x(), x()], largest * x());
        [0; 3].map(|_| centre.map(|c| c + size * x()))
    };
    let positions = (0..n).flat_map(&mut corners).collect();
    Mesh::new(positions, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).expect("a valid mesh")
}
