//! The scene's origin: coordinates are f64 in files, f32 in meshes.
//!
//! The rule: the origin is moved from `[0, 0, 0]` only if the largest coordinate is more than eight times the longest
//! side of the scene's box, that is, if the move makes the f32 step at least four times finer. It then lies at the
//! box's centre, rounded to a multiple of the largest power of two that is no more than an eighth of the longest side
//! (of the largest coordinate for a single point), so that subtracting it is exact or nearly so, and people can read
//! it. A city district of 524 m near (85,000; 447,500) gets the origin (84,864; 447,616; 0), and steps of 2⁻¹⁵ m
//! instead of 2⁻⁵ m.

use rdh::Vec3;

use super::grow;
use crate::error::{Error, Result};
use crate::scene::{Scene, Transform};

/// A box of f64 points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Bounds {
    /// The box of no point.
    pub(super) const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// The box of some points.
    pub(super) fn of<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, &p| b.with(p))
    }

    /// This box, grown to a point.
    pub(super) fn with(mut self, p: [f64; 3]) -> Self {
        for (axis, &x) in p.iter().enumerate() {
            self.min[axis] = self.min[axis].min(x);
            self.max[axis] = self.max[axis].max(x);
        }
        self
    }

    fn is_empty(&self) -> bool {
        self.min[0] > self.max[0]
    }

    /// The eight corners; none if the box is empty.
    fn corners(&self) -> impl Iterator<Item = [f64; 3]> {
        let Self { min, max } = *self;
        let count = if self.is_empty() { 0 } else { 8 };
        (0..count).map(move |k| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { min[axis] } else { max[axis] }))
    }
}

/// The origin that the rule gives.
pub(super) fn choose(bounds: &Bounds) -> [f64; 3] {
    if bounds.is_empty() {
        return [0.0; 3];
    }
    let size = (0..3).map(|a| bounds.max[a] - bounds.min[a]).fold(0.0, f64::max);
    let largest = (0..3).map(|a| bounds.max[a].abs().max(bounds.min[a].abs())).fold(0.0, f64::max);
    if largest <= 8.0 * size || largest == 0.0 {
        return [0.0; 3];
    }
    let step = power_of_two_below(if size > 0.0 { size / 8.0 } else { largest / 8.0 });
    [0, 1, 2].map(|a| ((bounds.min[a] + bounds.max[a]) / 2.0 / step).round() * step)
}

/// Positions relative to an origin.
pub(super) fn relative(positions: &[[f64; 3]], origin: [f64; 3]) -> Result<Vec<Vec3>> {
    let mut relative = Vec::new();
    grow::reserve(&mut relative, positions.len())?;
    relative.extend(positions.iter().map(|p| [0, 1, 2].map(|a| (p[a] - origin[a]) as f32)));
    Ok(relative)
}

/// Gives a scene whose origin is `[0, 0, 0]` the one of the rule, by moving its instances.
///
/// # Errors
/// An instance beyond the range of f32.
pub(super) fn settle(scene: &mut Scene) -> Result<()> {
    let origin = choose(&world_bounds(scene)?);
    if origin != [0.0; 3] {
        let back = Transform::translation(origin.map(|x| -x));
        scene.instances.iter_mut().for_each(|i| i.scene_from_object = back.after(&i.scene_from_object));
    }
    scene.origin = origin;
    Ok(())
}

/// A box around all instances: around their turned boxes, which is close enough for the rule.
fn world_bounds(scene: &Scene) -> Result<Bounds> {
    let in_f64 = |p: &Vec3| p.map(f64::from);
    let boxes: Vec<Bounds> =
        scene.geometries.iter().map(|g| g.positions.iter().fold(Bounds::EMPTY, |b, p| b.with(in_f64(p)))).collect();
    let mut bounds = Bounds::EMPTY;
    for (number, instance) in scene.instances.iter().enumerate() {
        for corner in boxes[instance.geometry].corners() {
            let p = instance.scene_from_object.point(corner);
            if p.iter().any(|x| !in_f32_range(*x)) {
                return Err(Error::at(format!("instance {number}"), "lies beyond the range of 32-bit floats"));
            }
            bounds = bounds.with(p);
        }
    }
    Ok(bounds)
}

fn in_f32_range(x: f64) -> bool {
    x.abs() <= f64::from(f32::MAX)
}

/// The largest power of two that is no more than a positive number (at least the smallest normal one).
fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_scenes_stay_where_they_are() {
        assert_eq!(choose(&Bounds::EMPTY), [0.0; 3]);
        assert_eq!(choose(&Bounds::of(&[[0.0; 3]])), [0.0; 3]);
        assert_eq!(choose(&Bounds::of(&[[0.0, -90.0, 682.0], [9780.0, 13860.0, 2543.0]])), [0.0; 3]);
        // Eight times the size exactly: not yet.
        assert_eq!(choose(&Bounds::of(&[[7.0, 0.0, 0.0], [8.0, 1.0, 1.0]])), [0.0; 3]);
    }

    #[test]
    fn far_scenes_move_to_a_round_centre() {
        let far = Bounds::of(&[[84616.468, 447422.999, -15.0], [85140.839, 447750.636, 13.8]]);
        assert_eq!(choose(&far), [84864.0, 447616.0, 0.0]);
        assert_eq!(choose(&Bounds::of(&[[1000.25, 0.0, 0.0]])), [1024.0, 0.0, 0.0]);
    }

    #[test]
    fn the_move_makes_far_positions_finer() {
        let points = [[84616.468, 447422.999, -15.0], [85140.839, 447750.636, 13.8]];
        let origin = choose(&Bounds::of(&points));
        for (near, far) in relative(&points, origin).unwrap().iter().zip(points) {
            for axis in 0..3 {
                assert!((f64::from(near[axis]) + origin[axis] - far[axis]).abs() <= 2e-5);
            }
        }
    }
}
