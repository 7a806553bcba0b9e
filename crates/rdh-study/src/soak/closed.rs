//! Closed meshes, and where inside of them rays may start: from there every ray hits something.

use std::collections::BTreeMap;

use rdh::{Mesh, Ray, Vec3};

use super::solid;
use crate::integrate::Random;

/// A closed mesh: each of its edges belongs to an even number of triangles.
#[derive(Debug, Clone)]
pub struct Closed {
    /// What it is called in tables.
    pub name: String,
    /// Its triangles.
    pub mesh: Mesh,
    /// Balls that lie inside, clear of the surface by more than rounding.
    pub inside: Vec<Ball>,
    /// How many rays it gets where an ordinary mesh gets 1.
    pub weight: f64,
}

/// Where rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub centre: Vec3,
    /// How far it reaches.
    pub radius: f32,
}

/// How finely the meshes are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// At most 2,000 triangles each: brute force looks at all of them.
    Coarse,
    /// 10,000 to 50,000 each.
    Fine,
}

/// Where a mesh is put, and how large it is there.
const PLACES: [(&str, f32, Vec3); 6] = [
    ("", 1.0, [0.0; 3]),
    // Where numbers are 2⁻⁹ apart: farther off the thinnest of them would be as thin as rounding.
    (" far away", 1.0, [14_837.6, 123.4, -22_342.3]),
    (" × 1e-30", 1e-30, [0.0; 3]),
    (" × 1e-12", 1e-12, [0.0; 3]),
    (" × 1e12", 1e12, [0.0; 3]),
    (" × 1e30", 1e30, [0.0; 3]),
];

/// Six closed meshes in six places each.
pub fn closed_meshes(detail: Detail) -> Vec<Closed> {
    let shapes = shapes(detail);
    shapes.iter().flat_map(|shape| PLACES.map(|(place, scale, to)| shape.moved(place, scale, to))).collect()
}

/// The parts of some meshes from each one on: how much of what is left it gets.
pub fn shares(meshes: &[Closed]) -> impl Iterator<Item = f64> {
    let left = |i: usize| meshes[i..].iter().map(|closed| closed.weight).sum::<f64>();
    meshes.iter().enumerate().map(move |(i, closed)| closed.weight / left(i))
}

/// A sphere whose structures are larger than caches: batches of rays without order take turns there.
pub fn large_mesh() -> Closed {
    let inside = vec![Ball { centre: [0.13, -0.07, 0.21], radius: 0.5 }];
    Closed { name: "large icosphere".to_owned(), mesh: icosphere(7), inside, weight: 1.0 }
}

fn shapes(detail: Detail) -> Vec<Closed> {
    let pick = |coarse, fine| if detail == Detail::Coarse { coarse } else { fine };
    let ball = |centre, radius| vec![Ball { centre, radius }];
    let off_centre = [0.13, -0.07, 0.21];
    let of = |name: &str, mesh, inside| Closed { name: name.to_owned(), mesh, inside, weight: 1.0 };
    vec![
        of("icosphere", icosphere(pick(3, 5)), ball(off_centre, 0.5)),
        of("box", cuboid(pick(12, 64), [1.0; 3]), ball(off_centre, 0.7)),
        of("plate", cuboid(pick(12, 48), [1.0, 1.0, 0.0625]), ball([0.13, -0.07, 0.003], 0.03)),
        // All of them meet at the poles, and a ray at a pole is tested against all: an ordinary share would take nine tenths of the time.
        Closed { weight: 0.1, ..of("needles", needles(pick(900, 5_000)), ball([0.01, 0.02, 0.03], 0.2)) },
        of("bumpy sphere", bumpy(pick(3, 5)), ball([0.01, 0.02, -0.01], 0.3)),
        of("solid", solid::mesh(pick(11, 44)), solid::INSIDE.to_vec()),
    ]
}

impl Closed {
    /// The same, made larger and then moved. Equal corners stay equal, so it stays closed.
    fn moved(&self, place: &str, scale: f32, to: Vec3) -> Self {
        let at = |p: Vec3| [0, 1, 2].map(|a| p[a] * scale + to[a]);
        let ball = |b: &Ball| Ball { centre: at(b.centre), radius: b.radius * scale };
        Self {
            name: format!("{}{place}", self.name),
            mesh: mesh(self.mesh.positions().iter().map(|&p| at(p)).collect(), self.mesh.triangles().to_vec()),
            inside: self.inside.iter().map(ball).collect(),
            weight: self.weight,
        }
    }
}

pub(super) fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(positions, triangles).expect("the generators make valid meshes")
}

/// A subdivided icosahedron of radius 1.
fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let signs = [-1.0, 1.0].into_iter().flat_map(|s| [-g, g].map(|t| (s, t)));
    let mut points: Vec<Vec3> = signs.flat_map(|(s, t)| [[s, t, 0.0], [0.0, s, t], [t, 0.0, s]]).collect();
    // Before they are brought to the sphere its edges have length 2, all other pairs are farther apart.
    let joined = |p: Vec3, q: Vec3| (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f32>() < 4.1;
    let corners = |i: usize| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| [i, j, k]));
    let is_face = |&[i, j, k]: &[usize; 3]| {
        joined(points[i], points[j]) && joined(points[j], points[k]) && joined(points[i], points[k])
    };
    let faces: Vec<[usize; 3]> = (0..12).flat_map(corners).filter(is_face).collect();
    let mut faces: Vec<[u32; 3]> = faces.into_iter().map(|face| face.map(|i| i as u32)).collect();
    points.iter_mut().for_each(|p| *p = unit(*p));
    for _ in 0..levels {
        faces = subdivided(&mut points, &faces);
    }
    mesh(points, faces)
}

fn subdivided(points: &mut Vec<Vec3>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let (p, q) = (points[a as usize], points[b as usize]);
            points.push(unit([0, 1, 2].map(|a| p[a] + q[a])));
            points.len() as u32 - 1
        })
    };
    let parts = faces.iter().flat_map(|&[a, b, c]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    });
    parts.collect()
}

fn unit(p: Vec3) -> Vec3 {
    let length = p.iter().map(|x| x * x).sum::<f32>().sqrt();
    p.map(|x| x / length)
}

/// A box about the origin, each face n × n rectangles: all triangles are parallel to axes, and their edges lie in split planes.
fn cuboid(n: u32, half: Vec3) -> Mesh {
    let (mut points, mut known, mut faces) = (Vec::new(), BTreeMap::new(), Vec::new());
    let mut corner = |p: [u32; 3]| {
        *known.entry(p).or_insert_with(|| {
            points.push([0, 1, 2].map(|a| (2.0 * p[a] as f32 / n as f32 - 1.0) * half[a]));
            points.len() as u32 - 1
        })
    };
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| [i, j]));
    for (axis, side, [i, j]) in (0..3)
        .flat_map(|a| [0, n].map(|side| (a, side)))
        .flat_map(|(a, side)| squares.clone().map(move |s| (a, side, s)))
    {
        let mut at = |i: u32, j: u32| {
            let mut p = [side; 3];
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (i, j);
            corner(p)
        };
        let q = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        faces.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    }
    mesh(points, faces)
}

/// A ball of long thin triangles from pole to pole.
fn needles(n: u32) -> Mesh {
    let angle = |i: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let equator = (0..n).map(|i| [angle(i).cos() as f32, angle(i).sin() as f32, 0.0]);
    let at = |i: u32| 2 + i % n;
    let faces = (0..n).flat_map(|i| [[0, at(i), at(i + 1)], [1, at(i + 1), at(i)]]);
    mesh([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]].into_iter().chain(equator).collect(), faces.collect())
}

/// A sphere with bumps, seen whole from its centre.
fn bumpy(levels: u32) -> Mesh {
    let sphere = icosphere(levels);
    let bump = |p: &Vec3| {
        let r = 1.0 + 0.2 * (7.0 * p[0]).sin() * (5.0 * p[1]).cos() + 0.1 * (11.0 * p[2]).sin();
        p.map(|x| x * r)
    };
    mesh(sphere.positions().iter().map(bump).collect(), sphere.triangles().to_vec())
}

/// Whether each edge belongs to an even number of triangles, where corners are the same if their coordinates are.
pub fn is_closed(mesh: &Mesh) -> bool {
    let key = |i: u32| mesh.positions()[i as usize].map(|x| (x + 0.0).to_bits());
    let mut odd = std::collections::BTreeSet::new();
    for &[a, b, c] in mesh.triangles() {
        for (a, b) in [(a, b), (b, c), (c, a)].map(|(a, b)| (key(a), key(b))) {
            let edge = (a.min(b), a.max(b));
            if a != b && !odd.insert(edge) {
                odd.remove(&edge);
            }
        }
    }
    odd.is_empty()
}

/// Points of a coarse grid that have an odd number of crossings in all of many directions, and the distance to the nearest of them
/// that is met: a ball of a part of that, which is checked again from its border. The largest four.
pub(super) fn find_inside(mesh: &Mesh) -> Vec<Ball> {
    let Ok(accel) = rdh::build(mesh, &rdh::Spec::default(), &rdh::Training::none(), &rdh::BuildOptions::default())
    else {
        return Vec::new();
    };
    let bounds = mesh.bounds();
    let mut random = Random::new(1, 1);
    let directions: Vec<Vec3> = (0..64).map(|_| random.on_sphere().map(|x| x as f32)).collect();
    let is_inside = |p: Vec3| {
        let mut hits = Vec::new();
        directions.iter().all(|&d| {
            accel.all_hits(&Ray::new(p, d), &mut hits);
            !hits.len().is_multiple_of(2)
        })
    };
    let reach = |p: Vec3| {
        let nearest = |d: &Vec3| accel.closest(&Ray::new(p, *d)).map_or(0.0, |hit| hit.t);
        directions.iter().map(nearest).fold(f32::INFINITY, f32::min)
    };
    const STEPS: u32 = 12;
    let at = |axis: usize, i: u32| {
        bounds.min[axis] + (bounds.max[axis] - bounds.min[axis]) * (i as f32 + 0.5) / STEPS as f32
    };
    let grid = (0..STEPS).flat_map(|x| (0..STEPS).flat_map(move |y| (0..STEPS).map(move |z| [x, y, z])));
    let points = grid.map(|[x, y, z]| [at(0, x), at(1, y), at(2, z)]).filter(|&p| is_inside(p));
    let mut balls: Vec<Ball> = points.map(|centre| Ball { centre, radius: 0.4 * reach(centre) }).collect();
    let on_border = |b: &Ball, d: &Vec3| [0, 1, 2].map(|a| b.centre[a] + b.radius * d[a]);
    balls.retain(|ball| ball.radius > 0.0 && directions.iter().all(|d| is_inside(on_border(ball, d))));
    balls.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    balls.truncate(4);
    balls
}

#[cfg(test)]
mod tests {
    use rdh::naive;

    use super::*;

    /// From the balls' centres and from their outermost points: an odd number of crossings in any direction.
    fn assert_inside(closed: &Closed) {
        let mut random = Random::new(3, 1);
        for ball in &closed.inside {
            for i in 0..40 {
                let (out, along) = (random.on_sphere(), random.on_sphere().map(|x| x as f32));
                let reach = if i == 0 { 0.0 } else { ball.radius };
                let from = [0, 1, 2].map(|a| ball.centre[a] + reach * out[a] as f32);
                let hits = naive::all_hits(&closed.mesh, &Ray::new(from, along)).len();
                assert!(hits % 2 == 1, "{}: {hits} from {from:?} along {along:?}", closed.name);
            }
        }
    }

    #[test]
    fn all_are_closed_and_the_balls_lie_inside() {
        for (detail, sizes) in [(Detail::Coarse, 500..=2000), (Detail::Fine, 10_000..=50_000)] {
            for closed in closed_meshes(detail) {
                assert!(is_closed(&closed.mesh), "{} has a hole", closed.name);
                assert!(sizes.contains(&closed.mesh.len()), "{}: {} triangles", closed.name, closed.mesh.len());
                assert_inside(&closed);
            }
        }
    }

    #[test]
    fn holes_are_seen() {
        let whole = icosphere(1);
        let open = mesh(whole.positions().to_vec(), whole.triangles()[1..].to_vec());
        assert!(is_closed(&whole) && !is_closed(&open));
    }
}
