//! The kinds of rays: what stands in a column of the table.

use std::str::FromStr;

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rdh::{Accel, Hit, Query, Ray, RayClass};
use serde::{Deserialize, Serialize};

use crate::integrate::{Lens, Stage};

/// A kind of rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Column {
    /// Primary rays in scan-line order, closest hit.
    Rows,
    /// The same rays in Morton order.
    Tiles,
    /// From the primary hits, in Morton order, to the scene's first point light, any hit. Surfaces that face away from the light
    /// cast none.
    Shadow,
    /// Cosine-distributed from the primary hits, in Morton order, closest hit.
    Bounce,
    /// The same, no longer than a tenth of the scene's diagonal, any hit.
    Ao,
    /// The rays of bounces in no order at all, closest hit.
    Shuffled,
}

impl Column {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 6] = [Self::Rows, Self::Tiles, Self::Shadow, Self::Bounce, Self::Ao, Self::Shuffled];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Tiles => "tiles",
            Self::Shadow => "shadow",
            Self::Bounce => "bounce",
            Self::Ao => "ao",
            Self::Shuffled => "shuffled",
        }
    }

    /// What is asked of its rays.
    pub fn query(self) -> Query {
        match self {
            Self::Rows | Self::Tiles | Self::Bounce | Self::Shuffled => Query::Closest,
            Self::Shadow | Self::Ao => Query::Occluded,
        }
    }

    /// What its rays are for.
    pub fn class(self) -> RayClass {
        match self {
            Self::Rows | Self::Tiles => RayClass::Primary,
            Self::Shadow => RayClass::Shadow,
            Self::Bounce | Self::Shuffled => RayClass::Bounce,
            Self::Ao => RayClass::Ao,
        }
    }

    /// Whether neighbouring rays are alike.
    pub fn is_coherent(self) -> bool {
        matches!(self, Self::Rows | Self::Tiles | Self::Shadow)
    }
}

impl FromStr for Column {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let names = || Self::ALL.map(Self::name).join(", ");
        Self::ALL.into_iter().find(|c| c.name() == name).ok_or_else(|| format!("known columns: {}", names()))
    }
}

/// A square film; each pixel has one sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Film {
    /// Pixels across and down.
    pub(crate) size: usize,
    /// Whether samples lie anywhere in their pixels, or in the middle.
    pub(crate) jitter: bool,
    /// What all randomness comes from.
    pub(crate) seed: u64,
}

/// All primary rays of a view and where they end, from which the columns are made.
pub(crate) struct Frame<'a> {
    stage: &'a Stage,
    /// In scan-line order.
    primary: Vec<(Ray, Option<Hit>)>,
    size: usize,
    seed: u64,
}

impl<'a> Frame<'a> {
    /// Casts the primary rays through any structure of the stage.
    pub(crate) fn new(stage: &'a Stage, accel: &Accel, lens: &Lens, film: Film) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(film.seed);
        let mut within = || if film.jitter { unit(&mut random) } else { 0.5 };
        let size = film.size as f64;
        let mut ray = |i: usize| {
            let (x, y) = ((i % film.size) as f64 + within(), (i / film.size) as f64 + within());
            lens.ray(x / size, y / size)
        };
        let rays = (0..film.size * film.size).map(&mut ray);
        let primary = rays.map(|ray| (ray, accel.closest(&ray))).collect();
        Self { stage, primary, size: film.size, seed: film.seed }
    }

    /// The rays of a column.
    pub(crate) fn rays(&self, column: Column) -> Vec<Ray> {
        if column == Column::Rows {
            return self.primary.iter().map(|(ray, _)| *ray).collect();
        }
        if column == Column::Shuffled {
            return self.shuffled();
        }
        let in_tiles = self.tile_order().into_iter().map(|i| &self.primary[i]);
        if column == Column::Tiles {
            return in_tiles.map(|(ray, _)| *ray).collect();
        }
        let mut random = Pcg64Mcg::seed_from_u64(self.seed << 8 ^ column as u64);
        in_tiles.filter_map(|(ray, hit)| self.secondary(column, ray, hit.as_ref()?, &mut random)).collect()
    }

    /// By Fisher and Yates.
    fn shuffled(&self) -> Vec<Ray> {
        let mut rays = self.rays(Column::Bounce);
        let mut random = Pcg64Mcg::seed_from_u64(self.seed << 8 ^ Column::Shuffled as u64);
        for last in (1..rays.len()).rev() {
            rays.swap(last, (random.next_u64() % (last as u64 + 1)) as usize);
        }
        rays
    }

    fn tile_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.primary.len()).collect();
        order.sort_by_key(|i| spread(i % self.size) | spread(i / self.size) << 1);
        order
    }

    fn secondary(&self, column: Column, ray: &Ray, hit: &Hit, random: &mut Pcg64Mcg) -> Option<Ray> {
        let (point, normal) = self.leave(ray, hit)?;
        let along = |d: V3| Ray::new(point.map(|x| x as f32), d.map(|x| x as f32));
        match column {
            Column::Shadow => {
                let to_light = sub(self.stage.lights()[0].map(f64::from), point);
                let distance = dot(to_light, to_light).sqrt();
                let ray = along(to_light.map(|x| x / distance)).within(0.0, distance as f32);
                (dot(to_light, normal) > 0.0).then_some(ray)
            }
            Column::Ao => Some(along(cosine(normal, random)).within(0.0, self.stage.bounds().diagonal() * 0.1)),
            _ => Some(along(cosine(normal, random))),
        }
    }

    /// A point a little off the surface on the side that the ray came from, and the normal there. Nothing for triangles
    /// whose normal can't be computed.
    ///
    /// The offset is 2⁻¹⁸ of the coordinates' size: other libraries' triangle tests err by more than ours, and a ray that
    /// hits what it leaves measures nothing.
    fn leave(&self, ray: &Ray, hit: &Hit) -> Option<(V3, V3)> {
        let [a, b, c] = self.stage.mesh().corners(hit.tri).map(|p| p.map(f64::from));
        let (ab, ac) = (sub(b, a), sub(c, a));
        let normal = normalised(cross(ab, ac))?;
        let facing = if dot(normal, ray.direction.map(f64::from)) > 0.0 { normal.map(|x| -x) } else { normal };
        let size = [a, b, c].as_flattened().iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let offset = size / f64::from(1 << 18);
        let at = |i: usize| a[i] + f64::from(hit.u) * ab[i] + f64::from(hit.v) * ac[i] + offset * facing[i];
        Some(([at(0), at(1), at(2)], facing))
    }
}

type V3 = [f64; 3];

fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normalised(a: V3) -> Option<V3> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}

fn unit(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// A cosine-distributed direction about a normal: the normal plus a point on the unit sphere.
fn cosine(normal: V3, random: &mut Pcg64Mcg) -> V3 {
    loop {
        let in_cube = [(); 3].map(|()| 2.0 * unit(random) - 1.0);
        let square = dot(in_cube, in_cube);
        if !(1e-6..=1.0).contains(&square) {
            continue;
        }
        let length = square.sqrt();
        let sum = [0, 1, 2].map(|i| normal[i] + in_cube[i] / length);
        if let Some(direction) = normalised(sum).filter(|d| dot(*d, normal) > 0.0) {
            return direction;
        }
    }
}

/// The bits of a number below 2¹⁶ at the even places.
fn spread(x: usize) -> u64 {
    (0..16).map(|bit| (x as u64 >> bit & 1) << (2 * bit)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::Mode;
    use rdh::{BuildOptions, Spec, Training};

    #[test]
    fn columns_are_made_of_the_same_primary_rays() {
        let entry = rdh_scene::catalog::find("tetra6", &[]).unwrap();
        let stage = Stage::new(&entry.load(0).unwrap()).unwrap();
        let accel = rdh::build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        let lens = Lens::new(&stage, Mode::Primary, &entry.views[0], 1.0);
        let frame = Frame::new(&stage, &accel, &lens, Film { size: 50, jitter: false, seed: 1 });
        let bits = |ray: &Ray| bytemuck::cast::<Ray, [u32; 9]>(*ray);
        let sorted = |column| {
            let mut rays: Vec<_> = frame.rays(column).iter().map(bits).collect();
            rays.sort_unstable();
            rays
        };
        assert_eq!(sorted(Column::Rows).len(), 2500);
        assert_eq!(sorted(Column::Rows), sorted(Column::Tiles));
        assert_eq!(sorted(Column::Bounce), sorted(Column::Shuffled));
        assert_ne!(frame.rays(Column::Bounce), frame.rays(Column::Shuffled));
        let hits = frame.rays(Column::Rows).iter().filter(|ray| accel.closest(ray).is_some()).count();
        let (bounces, short) = (frame.rays(Column::Bounce), frame.rays(Column::Ao));
        assert!(hits > 100 && bounces.len() == hits && short.len() == hits);
        assert!(short.iter().all(|ray| ray.is_valid() && ray.t_max == stage.bounds().diagonal() * 0.1));
        // Rays that leave a surface don't hit it at once.
        assert!(bounces.iter().filter_map(|ray| accel.closest(ray)).all(|hit| hit.t > 1e-4));
        for ray in frame.rays(Column::Shadow) {
            let gap = (0..3).map(|a| (ray.at(ray.t_max)[a] - stage.lights()[0][a]).abs()).fold(0.0, f32::max);
            assert!(gap < 1e-4, "{gap}");
        }
    }

    #[test]
    fn morton_order_fills_squares() {
        let code = |x, y| spread(x) | spread(y) << 1;
        assert_eq!([code(0, 0), code(1, 0), code(0, 1), code(1, 1), code(2, 0)], [0, 1, 2, 3, 4]);
        assert_eq!(code(0xffff, 0xffff), 0xffff_ffff);
    }

    #[test]
    fn directions_are_cosine_distributed() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let normal = [0.6, 0.0, 0.8];
        let n = 100_000;
        let cosines: Vec<f64> = (0..n).map(|_| dot(cosine(normal, &mut random), normal)).collect();
        // The mean of cos is 2/3, of its square 1/2.
        let mean = cosines.iter().sum::<f64>() / f64::from(n);
        let square = cosines.iter().map(|c| c * c).sum::<f64>() / f64::from(n);
        assert!((mean - 2.0 / 3.0).abs() < 0.004 && (square - 0.5).abs() < 0.005, "{mean} {square}");
    }
}
