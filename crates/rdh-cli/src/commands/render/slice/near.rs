//! Which sampled rays are near a plane.

use rdh::{Aabb, RaySample};

use super::Plane;

/// The part of a ray near the plane, in the plane's two axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NearRay {
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    /// Whether the ray's hit is where this part ends.
    pub(super) hit_near: bool,
}

/// The rays that stay near the plane for the largest part of their way, at most so many; each within the box, up to its end.
pub(super) fn rays_near(samples: &[RaySample], plane: &Plane, bounds: &Aabb, most: usize) -> Vec<NearRay> {
    let mut near: Vec<_> = samples.iter().filter_map(|s| near_part(s, plane, bounds)).collect();
    // A stable sort: among equals the order of the sample, which is random and repeatable.
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    near.into_iter().map(|(_, ray)| ray).take(most).collect()
}

/// The part of a ray near the plane, and which share of its way that is.
fn near_part(sample: &RaySample, plane: &Plane, bounds: &Aabb) -> Option<(f64, NearRay)> {
    let ray = &sample.ray;
    let (enter, leave) = bounds.clip_line(ray.origin, ray.direction, 0.0)?;
    let start = f64::from(ray.t_min.max(enter));
    let end = f64::from(sample.t_end().min(leave));
    let (first, last) = slab(f64::from(ray.origin[plane.axis]), f64::from(ray.direction[plane.axis]), plane);
    let (from, to) = (start.max(first), end.min(last));
    if from >= to {
        return None;
    }
    let at = |t: f64| Plane::axes(plane.axis).map(|a| f64::from(ray.origin[a]) + t * f64::from(ray.direction[a]));
    let hit_near = sample.t_hit.is_some_and(|t| f64::from(t) <= to);
    Some(((to - from) / (end - start), NearRay { from: at(from), to: at(to), hit_near }))
}

/// Between which `t` a line is near the plane; `first > last` if nowhere.
fn slab(origin: f64, direction: f64, plane: &Plane) -> (f64, f64) {
    let (low, high) = (plane.position - plane.near - origin, plane.position + plane.near - origin);
    if direction == 0.0 {
        let inside = low <= 0.0 && high >= 0.0;
        return if inside { (f64::NEG_INFINITY, f64::INFINITY) } else { (f64::INFINITY, f64::NEG_INFINITY) };
    }
    let (a, b) = (low / direction, high / direction);
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use rdh::{Query, Ray, RayClass};

    use super::*;

    const PLANE: Plane = Plane { axis: 0, position: 0.0, near: 1.0 };
    const BOUNDS: Aabb = Aabb { min: [-10.0; 3], max: [10.0; 3] };

    fn sample(origin: [f32; 3], direction: [f32; 3], t_hit: Option<f32>) -> RaySample {
        let (query, class) = (Query::Closest, RayClass::Primary);
        RaySample { ray: Ray::new(origin, direction), t_hit, query, class, weight: 1 }
    }

    #[test]
    fn a_ray_in_the_plane_is_drawn_to_its_hit() {
        let along = sample([0.0, -20.0, 0.0], [0.0, 1.0, 0.0], Some(25.0));
        let rays = rays_near(&[along], &PLANE, &BOUNDS, 9);
        assert_eq!(rays, [NearRay { from: [-10.0, 0.0], to: [5.0, 0.0], hit_near: true }]);
    }

    #[test]
    fn a_ray_across_is_drawn_near_the_plane_only_and_comes_last() {
        let across = sample([-5.0, 0.0, 0.0], [1.0, 0.0, 0.5], None);
        let along = sample([0.5, 0.0, 0.0], [0.0, 1.0, 0.0], None);
        let far = sample([5.0, 0.0, 0.0], [1.0, 0.0, 0.0], None);
        let rays = rays_near(&[across, along, far], &PLANE, &BOUNDS, 9);
        assert_eq!(rays.len(), 2);
        assert_eq!(rays[1], NearRay { from: [0.0, 2.0], to: [0.0, 3.0], hit_near: false });
    }
}
