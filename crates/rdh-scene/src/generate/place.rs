//! Transforms that put a unit shape somewhere. Angles are in degrees, turning counterclockwise seen against the axis.

use super::vector::{Point, add, cross, mul, sub, unit};
use crate::scene::Transform;

/// Scales each axis by its own factor.
pub(crate) fn stretch(by: Point) -> Transform {
    let mut t = Transform::IDENTITY;
    for (i, x) in by.into_iter().enumerate() {
        t.0[i][i] = x;
    }
    t
}

/// Maps the axes to three vectors and the origin to a point.
pub(crate) fn axes(x: Point, y: Point, z: Point, origin: Point) -> Transform {
    Transform([0, 1, 2].map(|i| [x[i], y[i], z[i], origin[i]]))
}

/// Turns about a direction of length 1 through the origin.
pub(crate) fn turn(axis: Point, degrees: f64) -> Transform {
    let (sin, cos) = quarter_exact(degrees);
    let image = |p: Point| {
        let along = mul(axis, super::vector::dot(axis, p));
        add(along, add(mul(sub(p, along), cos), mul(cross(axis, p), sin)))
    };
    axes(image([1.0, 0.0, 0.0]), image([0.0, 1.0, 0.0]), image([0.0, 0.0, 1.0]), [0.0; 3])
}

/// Turns about the vertical through the origin, then moves.
pub(crate) fn stand(at: Point, degrees: f64) -> Transform {
    Transform::translation(at).after(&turn([0.0, 0.0, 1.0], degrees))
}

/// The unit sphere, as a ball.
pub(crate) fn ball(centre: Point, radius: f64) -> Transform {
    Transform::translation(centre).after(&stretch([radius; 3]))
}

/// The unit tube (radius 1, from z = 0 to z = 1), from one point to another.
pub(crate) fn between(from: Point, to: Point, radius: f64) -> Transform {
    let along = sub(to, from);
    let z = unit(along);
    // The coordinate axis that is least along z: the cross product is then well conditioned.
    let least = (0..3).min_by(|&a, &b| z[a].abs().total_cmp(&z[b].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let x = unit(cross(other, z));
    let y = cross(z, x);
    axes(mul(x, radius), mul(y, radius), along, from)
}

/// Sine and cosine that are exact at right angles, so that boxes stay boxes.
pub(crate) fn quarter_exact(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}
