//! Meshes with known properties: closed ones, and nasty ones.

use std::collections::BTreeMap;

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rdh::Mesh;

/// A repeatable source of numbers in [0, 1).
pub struct Random(Pcg64Mcg);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    pub fn unit(&mut self) -> f32 {
        (self.0.next_u64() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn between(&mut self, a: f32, b: f32) -> f32 {
        a + (b - a) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.0.next_u64() % n as u64) as usize
    }

    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    pub fn vector(&mut self) -> [f32; 3] {
        [0; 3].map(|_| self.between(-1.0, 1.0))
    }
}

/// The closed meshes, and a point inside each from which every part of the surface is seen.
pub fn closed() -> Vec<(&'static str, Mesh, [f32; 3])> {
    let far = |p: [f32; 3]| [p[0] + 148_376.0, p[1] + 1_234.0, p[2] - 223_423.0];
    let inside = [0.13, -0.07, 0.21];
    vec![
        ("icosphere", icosphere(4), inside),
        ("box", tessellated_box(16), inside),
        ("needles", needle_sphere(2000), inside),
        ("far icosphere", moved(&icosphere(4), far), far(inside)),
        ("small icosphere", moved(&icosphere(4), |p| p.map(|x| x * 1e-6)), inside.map(|x| x * 1e-6)),
        ("tiny icosphere", moved(&icosphere(3), |p| p.map(|x| x * 1e-30)), inside.map(|x| x * 1e-30)),
        ("huge icosphere", moved(&icosphere(3), |p| p.map(|x| x * 1e30)), inside.map(|x| x * 1e30)),
        ("bumpy sphere", bumpy_sphere(5), [0.01, 0.02, -0.01]),
    ]
}

/// Meshes that builders choke on.
pub fn nasty() -> Vec<(&'static str, Mesh)> {
    let mut random = Random::new(3);
    let one = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    vec![
        ("empty", Mesh::default()),
        ("one triangle", mesh(one.clone(), vec![[0, 1, 2]])),
        ("a point", mesh(vec![[1.0, 2.0, 3.0]], vec![[0, 0, 0]; 50])),
        ("identical", mesh(one, vec![[0, 1, 2]; 2000])),
        ("soup", soup(800, 0.2, 1)),
        ("big soup", soup(200, 2.0, 2)),
        ("stacked planes", stacked_planes(40)),
        ("exponential", moved(&soup(300, 0.5, 4), |p| p.map(|x| x.signum() * (x.abs() * 60.0).exp2()))),
        ("denormal", moved(&soup(300, 0.3, 5), |p| p.map(|x| x * 1e-40))),
        ("huge", moved(&soup(300, 0.3, 6), |p| p.map(|x| x * 1e37))),
        ("flat", moved(&soup(300, 0.3, 8), |p| [p[0], p[1], 0.0])),
        ("grid", heights(24, |_, _| 0.0)),
        ("terrain", heights(24, move |_, _| random.unit() * 0.2)),
        (
            "axis lines",
            mesh((0..60).map(|i| [i as f32, 0.0, 0.0]).collect(), (0..58).map(|i| [i, i + 1, i + 2]).collect()),
        ),
    ]
}

pub fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(positions, triangles).expect("a valid mesh")
}

pub fn moved(m: &Mesh, f: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    mesh(m.positions().iter().map(|&p| f(p)).collect(), m.triangles().to_vec())
}

/// A subdivided icosahedron of radius 1.
pub fn icosphere(levels: usize) -> Mesh {
    let g = (1.0 + 5.0f32.sqrt()) / 2.0;
    let mut points: Vec<[f32; 3]> = Vec::new();
    for s in [-1.0, 1.0] {
        for t in [-g, g] {
            points.extend([[s, t, 0.0], [0.0, s, t], [t, 0.0, s]]);
        }
    }
    let edge = |a: [f32; 3], b: [f32; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>() < 4.1;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if edge(points[i], points[j]) && edge(points[j], points[k]) && edge(points[i], points[k]) {
                    faces.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    points.iter_mut().for_each(|p| *p = unit(*p));
    for _ in 0..levels {
        faces = subdivide(&mut points, &faces);
    }
    mesh(points, faces)
}

fn subdivide(points: &mut Vec<[f32; 3]>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let (p, q) = (points[a as usize], points[b as usize]);
            points.push(unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
            points.len() as u32 - 1
        })
    };
    let mut out = Vec::new();
    for &[a, b, c] in faces {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        out.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    out
}

pub fn unit(p: [f32; 3]) -> [f32; 3] {
    let length = p.iter().map(|x| x * x).sum::<f32>().sqrt();
    p.map(|x| x / length)
}

/// A cube from -1 to 1, each face n × n squares; shared vertices.
pub fn tessellated_box(n: u32) -> Mesh {
    let (mut points, mut index, mut faces) = (Vec::new(), BTreeMap::new(), Vec::new());
    let mut vertex = |p: [u32; 3]| {
        *index.entry(p).or_insert_with(|| {
            points.push(p.map(|x| 2.0 * x as f32 / n as f32 - 1.0));
            points.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        for side in [0, n] {
            for i in 0..n {
                for j in 0..n {
                    let mut at = |i: u32, j: u32| {
                        let mut p = [side; 3];
                        (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (i, j);
                        vertex(p)
                    };
                    let q = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    faces.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
                }
            }
        }
    }
    mesh(points, faces)
}

/// A ball of long thin triangles from pole to pole.
pub fn needle_sphere(n: u32) -> Mesh {
    let mut points = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for i in 0..n {
        let a = i as f32 / n as f32 * std::f32::consts::TAU;
        points.push([a.cos(), a.sin(), 0.0]);
    }
    let at = |i: u32| 2 + i % n;
    mesh(points, (0..n).flat_map(|i| [[0, at(i), at(i + 1)], [1, at(i), at(i + 1)]]).collect())
}

/// A star-shaped closed surface with bumps.
pub fn bumpy_sphere(levels: usize) -> Mesh {
    moved(&icosphere(levels), |p| {
        let r = 1.0 + 0.2 * (7.0 * p[0]).sin() * (5.0 * p[1]).cos() + 0.1 * (11.0 * p[2]).sin();
        p.map(|x| x * r)
    })
}

/// Random triangles of a size in [-1, 1]³.
pub fn soup(n: usize, size: f32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let mut points = Vec::new();
    for _ in 0..n {
        let centre = random.vector();
        for _ in 0..3 {
            let offset = random.vector();
            points.push([0, 1, 2].map(|a: usize| centre[a] + size * offset[a]));
        }
    }
    mesh(points, (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Many copies of one square, one above the other, each two triangles.
pub fn stacked_planes(n: u32) -> Mesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points = (0..n).flat_map(|i| corners.map(|[x, y]| [x, y, i as f32 * 0.1])).collect();
    mesh(points, (0..n).flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]).collect())
}

/// A height field over a unit square.
pub fn heights(n: u32, mut height: impl FnMut(u32, u32) -> f32) -> Mesh {
    let mut points = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            points.push([i as f32 / n as f32, j as f32 / n as f32, height(i, j)]);
        }
    }
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let square =
        |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    mesh(points, (0..n).flat_map(|j| (0..n).flat_map(move |i| square(i, j))).collect())
}
