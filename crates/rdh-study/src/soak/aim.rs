//! Rays from inside closed meshes, aimed where structures and triangle tests fail.

use rdh::{Accel, Ray, TriId, Vec3};

use super::closed::{Ball, Closed};
use crate::integrate::Random;

/// How a ray is aimed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Aim {
    /// At a vertex.
    Vertex,
    /// At a point of an edge, as near as numbers allow.
    Edge,
    /// Beside a vertex, by a step or two of each component.
    Beside,
    /// Along an axis or in a plane across one, with zeros of both signs; exactly through a vertex where one lies before the ball.
    Axis,
    /// In a split plane or the face of a box, at a vertex in it where there is one.
    Plane,
    /// Anywhere.
    Anywhere,
}

impl Aim {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 6] = [Self::Vertex, Self::Edge, Self::Beside, Self::Axis, Self::Plane, Self::Anywhere];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Edge => "edge",
            Self::Beside => "beside a vertex",
            Self::Axis => "axis",
            Self::Plane => "plane",
            Self::Anywhere => "anywhere",
        }
    }
}

/// What there is to aim at from a ball.
pub(super) struct Range<'a> {
    closed: &'a Closed,
    /// For each ball and axis.
    sights: Vec<[Sights; 3]>,
}

#[derive(Default)]
struct Sights {
    /// Vertices that a ray along the axis from the ball goes through.
    vertices: Vec<Vec3>,
    /// Planes across the axis that cut the ball.
    planes: Vec<f32>,
    /// Vertices in such planes.
    coplanar: Vec<Vec3>,
}

impl<'a> Range<'a> {
    /// The planes are those of the structures' leaf cells. O(vertices + cells).
    pub(super) fn new<'b>(closed: &'a Closed, structures: impl Iterator<Item = &'b Accel>) -> Self {
        let mut faces: [Vec<f32>; 3] = Default::default();
        for structure in structures {
            structure.cells(&mut |cell, _, _| {
                faces.iter_mut().enumerate().for_each(|(a, faces)| faces.extend([cell.min[a], cell.max[a]]));
            });
        }
        for faces in &mut faces {
            faces.sort_by(f32::total_cmp);
            faces.dedup();
        }
        let sights = closed.inside.iter().map(|ball| [0, 1, 2].map(|a| Sights::new(closed, ball, a, &faces[a])));
        Self { closed, sights: sights.collect() }
    }

    /// A ray from a ball.
    pub(super) fn ray(&self, aim: Aim, random: &mut Random) -> Ray {
        let ball = random.below(self.sights.len());
        let (from, axis) = (start(&self.closed.inside[ball], random), random.below(3));
        let sights = &self.sights[ball][axis];
        let ray = match aim {
            Aim::Vertex => towards(from, self.vertex(random)),
            Aim::Edge => towards(from, self.point_of_edge(random)),
            Aim::Beside => beside(towards(from, self.vertex(random)), random),
            Aim::Axis => along(from, axis, &sights.vertices, random),
            Aim::Plane => self.in_plane(from, axis, sights, random),
            Aim::Anywhere => Ray::new(from, [0; 3].map(|_| between(-1.0, 1.0, random))),
        };
        stretched(ray, random)
    }

    fn corners(&self, random: &mut Random) -> [Vec3; 3] {
        self.closed.mesh.corners(TriId(random.below(self.closed.mesh.len()) as u32))
    }

    /// Mostly any vertex alike. One of a triangle is often one where thousands of needles meet, and a ray there, which is tested
    /// against all of them, takes as long as thousands of others: these are every eighth.
    pub(super) fn vertex(&self, random: &mut Random) -> Vec3 {
        if random.below(8) == 0 {
            return self.corners(random)[random.below(3)];
        }
        let positions = self.closed.mesh.positions();
        positions[random.below(positions.len())]
    }

    pub(super) fn point_of_edge(&self, random: &mut Random) -> Vec3 {
        let (corners, first, part) = (self.corners(random), random.below(3), random.unit());
        let (p, q) = (corners[first], corners[(first + 1) % 3]);
        [0, 1, 2].map(|a| (f64::from(p[a]) + part * (f64::from(q[a]) - f64::from(p[a]))) as f32)
    }

    fn in_plane(&self, from: Vec3, axis: usize, sights: &Sights, random: &mut Random) -> Ray {
        if sights.planes.is_empty() {
            return along(from, axis, &sights.vertices, random);
        }
        let mut origin = from;
        let target = match sights.coplanar.len() {
            0 => self.vertex(random),
            n if random.below(2) == 0 => sights.coplanar[random.below(n)],
            _ => self.vertex(random),
        };
        let is_coplanar = sights.planes.binary_search_by(|x| x.total_cmp(&target[axis])).is_ok();
        origin[axis] = if is_coplanar { target[axis] } else { sights.planes[random.below(sights.planes.len())] };
        let mut ray = towards(origin, target);
        ray.direction[axis] = zero(random);
        ray
    }
}

impl Sights {
    fn new(closed: &Closed, ball: &Ball, axis: usize, faces: &[f32]) -> Self {
        let before = |p: Vec3, a: usize| (p[a] - ball.centre[a]).abs() < half_width(ball);
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let planes = faces.iter().copied().filter(|x| (x - ball.centre[axis]).abs() < half_width(ball)).collect();
        let mut sights = Self { planes, ..Self::default() };
        for &p in closed.mesh.positions() {
            if across.iter().all(|&a| before(p, a)) {
                sights.vertices.push(p);
            }
            if sights.planes.binary_search_by(|x| x.total_cmp(&p[axis])).is_ok() {
                sights.coplanar.push(p);
            }
        }
        sights
    }
}

/// Half the width of the cube in a ball: its corners stay within.
fn half_width(ball: &Ball) -> f32 {
    ball.radius * 0.57
}

/// A point of the cube in a ball; sometimes its centre.
pub(super) fn start(ball: &Ball, random: &mut Random) -> Vec3 {
    match random.below(4) {
        0 => ball.centre,
        _ => ball.centre.map(|x| x + between(-half_width(ball), half_width(ball), random)),
    }
}

fn towards(from: Vec3, target: Vec3) -> Ray {
    Ray::new(from, [0, 1, 2].map(|a| target[a] - from[a]))
}

/// The same ray, turned by two steps of a component at most.
fn beside(ray: Ray, random: &mut Random) -> Ray {
    let step = |x: f32, random: &mut Random| match random.below(5) {
        0 => x.next_down().next_down(),
        1 => x.next_down(),
        2 => x,
        3 => x.next_up(),
        _ => x.next_up().next_up(),
    };
    Ray { direction: ray.direction.map(|x| step(x, random)), ..ray }
}

/// Along an axis, through a vertex if there is one; or across an axis.
fn along(from: Vec3, axis: usize, vertices: &[Vec3], random: &mut Random) -> Ray {
    let mut direction = [0; 3].map(|_| zero(random));
    direction[axis] = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let mut origin = from;
    match random.below(3) {
        0 => direction[(axis + 1 + random.below(2)) % 3] = between(-1.0, 1.0, random),
        _ if vertices.is_empty() => {}
        _ => {
            let target = vertices[random.below(vertices.len())];
            origin = target;
            origin[axis] = from[axis];
        }
    }
    Ray::new(origin, direction)
}

/// The same ray with a direction of another length: 1, or any within 2^±20 of it. What would leave the range of numbers stays.
fn stretched(ray: Ray, random: &mut Random) -> Ray {
    let length = ray.direction.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
    let factor = match random.below(4) {
        0 => 1.0 / length,
        1 => (random.below(41) as f64 - 20.0).exp2(),
        _ => return ray,
    };
    let direction = ray.direction.map(|x| (f64::from(x) * factor) as f32);
    let usual = |x: &f32| *x == 0.0 || x.is_normal();
    let t = length * factor;
    if direction.iter().all(usual) && (1e-36..1e36).contains(&t) { Ray { direction, ..ray } } else { ray }
}

fn zero(random: &mut Random) -> f32 {
    if random.below(2) == 0 { 0.0 } else { -0.0 }
}

pub(super) fn between(low: f32, high: f32, random: &mut Random) -> f32 {
    low + (high - low) * random.unit() as f32
}
