//! Recursive ray tracing (Whitted, CACM 1980) by the rules of the Standard Procedural Databases: the primary ray has depth 1,
//! rays go to depth 5 whatever they contribute; every hit casts a shadow ray to each light in front of it; whatever reflects or
//! transmits casts a reflected ray, whatever transmits casts a refracted one unless it is reflected totally.
//!
//! Deviations: normals are geometric (no smooth shading), and "in front" is on the side from which the ray came unless the
//! surface transmits, because real models are not closed and their triangles are wound either way.

use rdh::{Ray, RayClass};

use super::caster::Caster;
use super::shade::{AMBIENT, BACKGROUND, light_from};
use super::stage::{Stage, SurfacePoint};
use super::vector::{V3, add, dot, scale, sub, unit, wide};

/// The primary ray is the first, its reflection the second.
pub(crate) const MAX_DEPTH: u32 = 5;

/// The tree of rays under one primary ray.
pub(crate) fn trace(stage: &Stage, ray: &Ray, caster: &mut impl Caster) -> f64 {
    follow(stage, ray, RayClass::Primary, 1, caster)
}

fn follow(stage: &Stage, ray: &Ray, class: RayClass, depth: u32, caster: &mut impl Caster) -> f64 {
    let Some(hit) = caster.closest(ray, class) else {
        return BACKGROUND;
    };
    let point = stage.surface(ray, &hit);
    let lit: f64 = stage.lights().iter().map(|&light| light_from(&point, light, caster)).sum();
    let share = 1.0 / stage.lights().len() as f64;
    let mut radiance = f64::from(point.material.diffuse) * (AMBIENT + (1.0 - AMBIENT) * share * lit);
    if depth < MAX_DEPTH {
        let (mirror, transmission) = (f64::from(point.material.mirror), f64::from(point.material.transmission));
        let incoming = wide(ray.direction);
        let through = if transmission > 0.0 { refracted(&point, incoming) } else { None };
        // What can't go through is reflected.
        let mirror = if through.is_none() { mirror + transmission } else { mirror };
        if mirror > 0.0 || transmission > 0.0 {
            let ray = point.spawn(reflected(&point, incoming));
            radiance += mirror * follow(stage, &ray, RayClass::Reflection, depth + 1, caster);
        }
        if let Some(direction) = through {
            let ray = point.spawn(direction);
            radiance += transmission * follow(stage, &ray, RayClass::Refraction, depth + 1, caster);
        }
    }
    radiance
}

fn reflected(point: &SurfacePoint, incoming: V3) -> V3 {
    let direction = sub(incoming, scale(point.normal, 2.0 * dot(incoming, point.normal)));
    unit(direction).unwrap_or(point.facing)
}

/// Snell's law; nothing for total reflection. A ray enters where it meets the outside of a triangle.
fn refracted(point: &SurfacePoint, incoming: V3) -> Option<V3> {
    let index = f64::from(point.material.index);
    let enters = dot(incoming, point.normal) <= 0.0;
    let ratio = if enters { 1.0 / index } else { index };
    let cosine = -dot(incoming, point.facing);
    let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if !(square >= 0.0 && ratio.is_finite()) {
        return None;
    }
    unit(add(scale(incoming, ratio), scale(point.facing, ratio * cosine - square.sqrt())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh_scene::Material;

    fn glass(incoming: V3, normal: V3) -> SurfacePoint {
        let facing = if dot(incoming, normal) > 0.0 { scale(normal, -1.0) } else { normal };
        let material = Material { diffuse: 0.0, mirror: 0.0, transmission: 1.0, index: 1.5 };
        SurfacePoint { position: [0.0; 3], normal, facing, offset: 0.0, material }
    }

    #[test]
    fn refraction_obeys_snells_law_both_ways() {
        let normal = [0.0, 0.0, 1.0];
        let down = unit([3.0, 0.0, -4.0]).unwrap();
        let inside = refracted(&glass(down, normal), down).unwrap();
        // sin = 0.6 outside, 0.4 inside glass of index 1.5.
        assert!((inside[0] - 0.4).abs() < 1e-12 && inside[1] == 0.0 && inside[2] < 0.0);
        // Coming back from below along the same line gives the first direction again.
        let up = scale(inside, -1.0);
        let outside = refracted(&glass(up, normal), up).unwrap();
        assert!(dot(outside, down) < -1.0 + 1e-12);
    }

    #[test]
    fn beyond_the_critical_angle_nothing_goes_through() {
        let normal = [0.0, 0.0, 1.0];
        let grazing = unit([0.7, 0.0, 0.7]).unwrap();
        assert_eq!(refracted(&glass(grazing, normal), grazing), None);
    }

    #[test]
    fn reflection_turns_the_normal_component_round() {
        let incoming = unit([1.0, 2.0, -3.0]).unwrap();
        let out = reflected(&glass(incoming, [0.0, 0.0, 1.0]), incoming);
        let expected = [incoming[0], incoming[1], -incoming[2]];
        assert!(dot(out, expected) > 1.0 - 1e-12);
    }
}
