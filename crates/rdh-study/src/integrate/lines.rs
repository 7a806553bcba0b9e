//! Uniform isotropic lines: the rays that the surface area heuristic assumes.

use rdh::{Aabb, Ray};

use super::random::Random;
use super::vector::{V3, add, cross, narrow, scale, unit, wide};

/// `count` lines that meet a box, uniform in place and direction: through uniform points of the disc across each direction. They start outside
/// of the box. Fewer only for an empty box.
pub fn uniform_lines(bounds: &Aabb, count: usize, seed: u64) -> Vec<Ray> {
    if bounds.is_empty() {
        return Vec::new();
    }
    // A flat box is met by few lines, but none is so thin that this would not end: half of a disc's lines meet a square in it.
    (0..count as u64).map(|i| line(bounds, &mut Random::new(seed, i))).collect()
}

fn line(bounds: &Aabb, random: &mut Random) -> Ray {
    let (centre, radius) = (wide(bounds.centre()), f64::from(bounds.diagonal()) * 0.5);
    const TRIES: usize = 10_000;
    let mut last = Ray::new(bounds.min, [0.0, 0.0, 1.0]);
    for _ in 0..TRIES {
        let direction = random.on_sphere();
        let (u, v) = (2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0);
        if u * u + v * v > 1.0 {
            continue;
        }
        let (x, y) = across(direction);
        let offset = add(scale(x, u * radius), scale(y, v * radius));
        let start = add(add(centre, offset), scale(direction, -2.0 * radius));
        last = Ray::new(narrow(start), narrow(direction));
        if bounds.clip_line(last.origin, last.direction, 0.0).is_some() {
            break;
        }
    }
    last
}

/// Two directions across `d` and each other, all of length 1.
fn across(d: V3) -> (V3, V3) {
    let helper = if d[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let x = unit(cross(d, helper)).unwrap_or([0.0, 0.0, 1.0]);
    (x, cross(d, x))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Aabb = Aabb { min: [-1.0, -2.0, 0.5], max: [2.0, 1.5, 1.25] };

    #[test]
    fn a_part_of_the_box_is_met_as_often_as_its_area_says() {
        let lines = uniform_lines(&BOX, 20_000, 3);
        let part = Aabb { max: [0.0, 1.0, 1.0], ..BOX };
        let met = lines.iter().filter(|l| part.clip_line(l.origin, l.direction, 0.0).is_some()).count();
        let area = |b: &Aabb| {
            let [x, y, z] = b.extent().map(f64::from);
            x * y + y * z + z * x
        };
        let expected = area(&part) / area(&BOX);
        let error = (expected * (1.0 - expected) / 20_000.0).sqrt();
        assert!((met as f64 / 20_000.0 - expected).abs() < 4.0 * error, "{met} of 20000, expected {expected}");
    }

    #[test]
    fn all_start_outside_and_meet_the_box_and_the_seed_decides() {
        let lines = uniform_lines(&BOX, 500, 1);
        assert!(lines.iter().all(|l| BOX.clip_line(l.origin, l.direction, 0.0).is_some_and(|c| c.0 > 0.0)));
        assert_eq!(lines, uniform_lines(&BOX, 500, 1));
        assert_ne!(lines, uniform_lines(&BOX, 500, 2));
        assert!(uniform_lines(&Aabb::EMPTY, 5, 1).is_empty());
    }
}
