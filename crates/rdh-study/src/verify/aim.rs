//! Rays that find what random rays don't: at edges and vertices, along axes, from inside and from outside.

use rdh::{Aabb, Mesh, Ray, TriId};

use crate::integrate::Random;

/// Rays through a mesh that are aimed in four ways in turn: at a vertex, at an edge, parallel to an axis through a vertex (with zeros of
/// both signs), and at a random point of the box; every third one ends near its aim or begins behind it. The same seed gives the
/// same rays. None for a mesh without triangles.
pub fn aimed_rays(mesh: &Mesh, count: usize, seed: u64) -> Vec<Ray> {
    if mesh.is_empty() {
        return Vec::new();
    }
    let bounds = mesh.bounds();
    (0..count).map(|i| aimed_ray(mesh, &bounds, i, &mut Random::new(seed, i as u64))).collect()
}

fn aimed_ray(mesh: &Mesh, bounds: &Aabb, i: usize, random: &mut Random) -> Ray {
    let from = start(bounds, random);
    let corners = mesh.corners(TriId(random.below(mesh.len()) as u32));
    let towards = |target: [f32; 3]| Ray::new(from, [0, 1, 2].map(|a| target[a] - from[a]));
    let ray = match i % 4 {
        0 => towards(corners[random.below(3)]),
        1 => {
            let (p, q, s) = (corners[0], corners[1 + random.below(2)], random.unit() as f32);
            towards([0, 1, 2].map(|a| p[a] + s * (q[a] - p[a])))
        }
        2 => along_axis(from, corners[random.below(3)], random),
        _ => towards(start(bounds, random)),
    };
    match i % 3 {
        0 => ray.within(0.0, 1.0),
        1 => ray,
        _ => ray.within(random.unit() as f32, f32::INFINITY),
    }
}

/// A point in the mesh's box, or around it by half its size.
fn start(bounds: &Aabb, random: &mut Random) -> [f32; 3] {
    let outside = random.below(2) as f64;
    [0, 1, 2].map(|a| {
        let (low, high) = (f64::from(bounds.min[a]), f64::from(bounds.max[a]));
        (low + (high - low) * (random.unit() * (1.0 + outside) - 0.5 * outside)) as f32
    })
}

/// A ray parallel to an axis, from the plane of `from` exactly through `target`.
fn along_axis(from: [f32; 3], target: [f32; 3], random: &mut Random) -> Ray {
    let axis = random.below(3);
    let mut direction = [0; 3].map(|_: i32| if random.below(2) == 0 { 0.0 } else { -0.0 });
    direction[axis] = if target[axis] < from[axis] { -1.0 } else { 1.0 };
    let mut origin = target;
    origin[axis] = from[axis];
    Ray::new(origin, direction)
}
