//! Rays, hits and ids.

use super::Vec3;

/// A ray: the points `origin + t · direction` for `t_min <= t <= t_max` (a closed interval).
///
/// As in Embree the direction need not be normalised, and `t` counts in units of its length.
/// A ray with a NaN, an infinite origin or direction, a zero direction or `t_min > t_max` is valid input: it hits nothing.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; any length but zero.
    pub direction: Vec3,
    /// The first `t` that counts.
    pub t_min: f32,
    /// The last `t` that counts; may be infinite.
    pub t_max: f32,
    /// Only triangles with a common bit are seen.
    pub mask: u32,
}

impl Ray {
    /// The whole half-line from `origin` along `direction`.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY, mask: u32::MAX }
    }

    /// The same ray, limited to `t_min <= t <= t_max`.
    pub fn within(self, t_min: f32, t_max: f32) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The same ray, seeing only triangles with a bit of `mask`.
    pub fn masked(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        [0, 1, 2].map(|a| self.origin[a] + t * self.direction[a])
    }

    /// Whether it can hit anything: finite, with a direction and a non-empty interval.
    #[inline(always)]
    pub fn is_valid(&self) -> bool {
        // A product with zero is NaN if a factor is infinite or NaN. No closures: this is compiled into kernels, where
        // closures lose the kernel's instruction set.
        let ([ox, oy, oz], [dx, dy, dz]) = (self.origin, self.direction);
        let finite = (ox * 0.0 + oy * 0.0 + oz * 0.0) + (dx * 0.0 + dy * 0.0 + dz * 0.0) == 0.0;
        let moves = dx != 0.0 || dy != 0.0 || dz != 0.0;
        finite && moves && self.t_min <= self.t_max
    }

    /// `[ox, oy, oz, dx, dy, dz, t_min, t_max]`.
    #[inline(always)]
    pub(crate) fn numbers(&self) -> &[f32; 8] {
        let all: &[f32; 9] = bytemuck::cast_ref(self);
        let Some(numbers) = all.first_chunk() else { unreachable!() };
        numbers
    }
}

/// `[ox, oy, oz, dx, dy, dz, t_min, t_max]`, the layout of ray files and NumPy batches; sees all masks.
impl From<[f32; 8]> for Ray {
    fn from(r: [f32; 8]) -> Self {
        Self { origin: [r[0], r[1], r[2]], direction: [r[3], r[4], r[5]], t_min: r[6], t_max: r[7], mask: u32::MAX }
    }
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// As an array index.
            #[inline(always)]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}
id!(
    /// A triangle: its index in the mesh.
    TriId
);
id!(
    /// A geometry of a scene; 0 where there is only one mesh.
    GeomId
);
id!(
    /// An instance of a scene; 0 where there is only one mesh.
    InstId
);

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance in units of the direction's length.
    pub t: f32,
    /// Weight of the triangle's second corner.
    pub u: f32,
    /// Weight of the triangle's third corner; the first one's is `1 - u - v`.
    pub v: f32,
    /// Which triangle.
    pub tri: TriId,
    /// Which geometry it belongs to.
    pub geometry: GeomId,
    /// Which instance of it.
    pub instance: InstId,
}

impl Hit {
    /// Nearer first, and at equal distance the smaller id: the order in which hits win.
    #[inline(always)]
    pub fn wins_over(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.tri < other.tri)
    }
}
