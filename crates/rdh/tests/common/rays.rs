//! Rays that find what random rays don't.

use rdh::{Mesh, Ray, TriId};

use super::meshes::Random;

/// How a ray is aimed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    Edge,
    Vertex,
    Axis,
    Anywhere,
}

pub const AIMS: [Aim; 4] = [Aim::Edge, Aim::Vertex, Aim::Axis, Aim::Anywhere];

/// A ray from near `inside` at a point of the mesh; along an axis it starts beside a vertex instead.
pub fn aimed(mesh: &Mesh, inside: [f32; 3], aim: Aim, random: &mut Random) -> Ray {
    let corners = mesh.corners(TriId(random.below(mesh.len()) as u32));
    let size = mesh.bounds().diagonal() * 0.02;
    let from = inside.map(|x| x + size * random.between(-1.0, 1.0));
    let target = match aim {
        Aim::Vertex | Aim::Axis => corners[random.below(3)],
        Aim::Edge => {
            let (p, q, s) = (corners[0], corners[1 + random.below(2)], random.unit());
            [0, 1, 2].map(|a| p[a] + s * (q[a] - p[a]))
        }
        Aim::Anywhere => {
            let d = random.vector();
            return Ray::new(from, d.map(|x| x * size));
        }
    };
    if aim == Aim::Axis {
        return along_axis(inside, target, random);
    }
    Ray::new(from, [0, 1, 2].map(|a| target[a] - from[a]))
}

/// A ray parallel to an axis that passes exactly through `target`, from the plane of `inside`, with zeros of both signs.
fn along_axis(inside: [f32; 3], target: [f32; 3], random: &mut Random) -> Ray {
    let axis = random.below(3);
    let mut origin = target;
    origin[axis] = inside[axis];
    let zero = |bit: u32| if bit & 1 == 0 { 0.0 } else { -0.0 };
    let mut direction = [zero(random.bits()), zero(random.bits()), zero(random.bits())];
    direction[axis] = if target[axis] < inside[axis] { -1.0 } else { 1.0 };
    Ray::new(origin, direction)
}

/// Rays of all kinds through a mesh: random lines, aimed ones, axis-parallel ones, short and long ones, in faces of boxes.
pub fn mixed(mesh: &Mesh, n: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let bounds = mesh.bounds();
    if bounds.is_empty() {
        return vec![Ray::new([0.0; 3], [1.0, 0.0, 0.0]); n];
    }
    (0..n).map(|i| one(mesh, &bounds, i, &mut random)).collect()
}

fn one(mesh: &Mesh, bounds: &rdh::Aabb, i: usize, random: &mut Random) -> Ray {
    let inside = |r: &mut Random| [0, 1, 2].map(|a: usize| r.between(bounds.min[a], bounds.max[a]));
    let (p, q) = (inside(random), inside(random));
    let ray = match i % 6 {
        0 => Ray::new(p, [0, 1, 2].map(|a| q[a] - p[a])),
        1 => aimed(mesh, p, Aim::Edge, random),
        2 => aimed(mesh, p, Aim::Vertex, random),
        3 => aimed(mesh, p, Aim::Axis, random),
        4 => {
            // In a face of the box, or in a plane through a vertex.
            let corner = mesh.corners(TriId(random.below(mesh.len()) as u32))[0];
            let axis = random.below(3);
            let mut direction = [0, 1, 2].map(|a| q[a] - p[a]);
            direction[axis] = 0.0;
            let mut origin = p;
            origin[axis] = if random.unit() < 0.5 { corner[axis] } else { bounds.min[axis] };
            Ray::new(origin, direction)
        }
        _ => {
            let scale = (random.between(-20.0, 20.0)).exp2();
            Ray::new(p, [0, 1, 2].map(|a| (q[a] - p[a]) * scale))
        }
    };
    match i % 5 {
        0 => ray.within(0.25, 0.75),
        1 => ray.within(f32::NEG_INFINITY, f32::INFINITY),
        _ => ray,
    }
}

/// Rays as batches have them: pictures in rows, bundles at edges and vertices and along axes from one point or towards one, parallel
/// ones, rays of all kinds, and among them some that hit nothing or need care.
pub fn batch(mesh: &Mesh, inside: [f32; 3], n: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let mut rays = Vec::new();
    while rays.len() < n {
        let kind = if mesh.is_empty() { 1 } else { random.below(6) };
        let mut some = match kind {
            0 => picture(mesh, inside, &mut random),
            1 => mixed(mesh, 40, random.bits().into()),
            _ => bundle(mesh, inside, kind, &mut random),
        };
        if random.below(3) == 0 {
            spoil(&mut some, &mut random);
        }
        rays.append(&mut some);
    }
    rays.truncate(n);
    rays
}

/// Rows of 24 rays from one point.
fn picture(mesh: &Mesh, inside: [f32; 3], random: &mut Random) -> Vec<Ray> {
    let (middle, step) = (random.vector(), random.between(0.0005, 0.03));
    let from = if random.below(2) == 0 { inside } else { outside(mesh, random) };
    let ray = |i: usize| {
        let (x, y) = ((i % 24) as f32 * step, (i / 24) as f32 * step);
        Ray::new(from, [middle[0] + x, middle[1] + y, middle[2]])
    };
    (0..24 * 11).map(ray).collect()
}

fn outside(mesh: &Mesh, random: &mut Random) -> [f32; 3] {
    let (bounds, aside) = (mesh.bounds(), random.vector());
    [0, 1, 2].map(|a| bounds.min[a] + aside[a] * (bounds.max[a] - bounds.min[a]))
}

/// Neighbouring rays at one edge or vertex, and exactly through it now and then: from one point, towards one, or side by side.
fn bundle(mesh: &Mesh, inside: [f32; 3], kind: usize, random: &mut Random) -> Vec<Ray> {
    let aim = AIMS[random.below(AIMS.len())];
    let first = aimed(mesh, inside, aim, random);
    let width = random.between(-30.0, -4.0).exp2();
    let near = |x: [f32; 3], scale: f32, random: &mut Random| {
        let exact = random.below(4) == 0;
        if exact { x } else { x.map(|x| x + scale * width * random.between(-1.0, 1.0)) }
    };
    let (reach, size) = (first.direction.iter().fold(0.0f32, |m, x| m.max(x.abs())), mesh.bounds().diagonal());
    let one = |random: &mut Random| match kind {
        2 | 3 => Ray { direction: near(first.direction, reach, random), ..first },
        4 => Ray { origin: near(first.origin, size, random), ..first },
        _ => {
            let (to, from) = (first.at(1.0), near(first.origin, size, random));
            Ray::new(from, [0, 1, 2].map(|a| to[a] - from[a])).within(0.0, 1.0)
        }
    };
    (0..random.below(90)).map(|_| one(random)).collect()
}

/// Makes some rays invalid, or such as need care.
fn spoil(rays: &mut [Ray], random: &mut Random) {
    if rays.is_empty() {
        return;
    }
    for _ in 0..3 {
        let ray = &mut rays[random.below(rays.len())];
        let axis = random.below(3);
        match random.below(8) {
            0 => ray.direction = [0.0, -0.0, 0.0],
            1 => ray.direction[axis] = f32::NAN,
            2 => ray.origin[axis] = f32::INFINITY,
            3 => *ray = ray.within(2.0, 1.0),
            4 => ray.direction = ray.direction.map(|x| x * 1e30),
            5 => ray.direction = ray.direction.map(|x| x * 1e-30),
            6 => *ray = ray.within(f32::NAN, f32::NAN),
            _ => ray.origin[axis] -= 1e25,
        }
    }
}
