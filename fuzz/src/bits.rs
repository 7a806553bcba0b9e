//! Bytes taken apart into numbers; zeros when they run out.

use std::ops::{Add, Mul, Sub};

use rdh::precise::{MeshF64, RayF64};
use rdh::{Mesh, Ray, TriId};

/// f32 and f64.
trait Number: Copy + From<f32> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl Number for f32 {}
impl Number for f64 {}

pub(crate) struct Bits<'a> {
    data: &'a [u8],
}

impl<'a> Bits<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Self {
        Self { data }
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.data.split_first() else { return 0 };
        self.data = rest;
        first
    }

    pub(crate) fn word(&mut self) -> u32 {
        u32::from_le_bytes([0; 4].map(|_| self.byte()))
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.byte() as usize % n.max(1)
    }

    /// Any bits, or a small number: those meet in ties and zeros.
    pub(crate) fn float(&mut self) -> f32 {
        match self.below(4) {
            0 => f32::from_bits(self.word()),
            _ => f32::from(self.byte() as i8) / 16.0,
        }
    }

    /// Any bits within the range that double precision promises, or a small number, with few digits or with all of them.
    pub(crate) fn double(&mut self) -> f64 {
        let x = match self.below(4) {
            0 => f64::from_bits(u64::from(self.word()) << 32 | u64::from(self.word())),
            1 => f64::from(self.byte() as i8) / 3.0,
            _ => f64::from(self.byte() as i8) / 16.0,
        };
        if x == 0.0 || (1e-250..1e250).contains(&x.abs()) { x } else { 0.5 }
    }

    /// From anywhere, at a corner, at an edge or along an axis.
    pub(crate) fn ray_f64(&mut self, mesh: &MeshF64) -> RayF64 {
        let origin = [0; 3].map(|_| self.double());
        let direction = self.direction(origin, Self::double, mesh.len(), |tri| mesh.corners(tri));
        let mut limit = |usual: f64| if self.below(4) == 0 { self.double() } else { usual };
        RayF64::new(origin, direction).within(limit(f64::NEG_INFINITY), limit(f64::INFINITY))
    }

    /// A coordinate as clippers see them: meshes are scaled before, so that none is beyond 2²⁰.
    pub(crate) fn scaled(&mut self) -> f32 {
        let x = self.float();
        if x.abs() <= (1 << 20) as f32 { x } else { 0.5 }
    }

    /// From anywhere, at a corner, at an edge or along an axis.
    pub(crate) fn ray(&mut self, mesh: &Mesh) -> Ray {
        let origin = [0; 3].map(|_| self.float());
        let direction = self.direction(origin, Self::float, mesh.len(), |tri| mesh.corners(tri));
        Ray::new(origin, direction).within(self.limit(f32::NEG_INFINITY), self.limit(f32::INFINITY))
    }

    /// Anywhere, at a corner or the middle of an edge of one of so many triangles, or along an axis.
    fn direction<T: Number>(
        &mut self,
        origin: [T; 3],
        number: fn(&mut Self) -> T,
        triangles: usize,
        corners: impl Fn(TriId) -> [[T; 3]; 3],
    ) -> [T; 3] {
        match self.below(3) {
            0 => [0; 3].map(|_| number(self)),
            1 if triangles > 0 => {
                let corners = corners(TriId(self.below(triangles) as u32));
                let (at, part) = (corners[self.below(3)], T::from([0.0, 0.5][self.below(2)]));
                [0, 1, 2].map(|a| at[a] + part * (corners[0][a] - at[a]) - origin[a])
            }
            _ => {
                let mut direction = [0; 3].map(|_| T::from([0.0, -0.0][self.below(2)]));
                direction[self.below(3)] = T::from([1.0, -1.0][self.below(2)]);
                direction
            }
        }
    }

    fn limit(&mut self, usual: f32) -> f32 {
        if self.below(4) == 0 { self.float() } else { usual }
    }
}
