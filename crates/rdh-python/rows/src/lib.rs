//! Rows of numbers as rays, and hits as points: what the Python module does for every ray, without Python.
//!
//! A crate of its own because it is built for speed, where the rest of the module is built to be small.

mod meetings;
mod rays;

pub use meetings::{Meeting, place_meetings};
pub use rays::RayRows;

/// Numbers that lie one after the other, in one of the two sizes that rays and vertices are wanted in.
#[derive(Debug, Clone, Copy)]
pub enum Numbers<'a> {
    /// As they are traced.
    F32(&'a [f32]),
    /// Everything else becomes these first.
    F64(&'a [f64]),
}

impl Numbers<'_> {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::F32(all) => all.len(),
            Self::F64(all) => all.len(),
        }
    }

    /// Three that belong together.
    #[inline(always)]
    pub fn triple(&self, at: usize) -> [f64; 3] {
        match self {
            Self::F32(all) => std::array::from_fn(|k| f64::from(all[at + k])),
            Self::F64(all) => std::array::from_fn(|k| all[at + k]),
        }
    }
}

/// The direction in which the corners run counter-clockwise, of length 1.
pub fn unit_normal(corners: [rdh::Vec3; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    let side = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v) = (side(b), side(c));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { n.map(|x| (x / length) as f32) } else { [0.0; 3] }
}
