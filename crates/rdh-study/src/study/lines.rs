//! Uniform lines: the rays that SAH has in mind.

use rdh::{Aabb, Query, Ray, RayClass};

use crate::integrate::{Random, RayBatch};

/// Isotropic uniform lines that meet a box, as half-lines from outside: chords of the sphere around it, each through two
/// uniform points of the sphere. Fewer than `count` only if the box is so flat that lines hardly ever meet it.
pub fn uniform_lines(bounds: &Aabb, count: usize, seed: u64) -> RayBatch {
    let centre = bounds.centre().map(f64::from);
    let radius = 0.5 * f64::from(bounds.diagonal());
    let mut rays = Vec::with_capacity(count);
    for index in 0..100 * count as u64 {
        if rays.len() == count || radius <= 0.0 {
            break;
        }
        let mut random = Random::new(seed, index);
        let (from, to) = (random.on_sphere(), random.on_sphere());
        let origin = [0, 1, 2].map(|a| (centre[a] + radius * from[a]) as f32);
        let direction = [0, 1, 2].map(|a| (to[a] - from[a]) as f32);
        if bounds.clip_line(origin, direction, 0.0).is_some() {
            rays.push(Ray::new(origin, direction));
        }
    }
    RayBatch { class: RayClass::Other, query: Query::Closest, rays }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_meet_boxes_as_often_as_their_areas_say() {
        let bounds = Aabb { min: [0.0; 3], max: [4.0, 2.0, 1.0] };
        let part = Aabb { min: [1.0, 0.5, 0.0], max: [2.0, 1.5, 1.0] };
        let lines = uniform_lines(&bounds, 40_000, 5).rays;
        assert_eq!(lines.len(), 40_000);
        let met =
            lines.iter().filter(|r| part.clip_line(r.origin, r.direction, 0.0).is_some()).count() as f64 / 40_000.0;
        // 6 / 28; 4 standard errors.
        let expected: f64 = 6.0 / 28.0;
        assert!((met - expected).abs() < 4.0 * (expected * (1.0 - expected) / 40_000.0).sqrt(), "{met}");
    }
}
