//! How far rays have moved away from a profile: whether it is time to record and build again.
//!
//! Rays become points: where they start, where they go, how far they get, and what they are for. Two clouds of points are
//! compared by their energy distance (Székely and Rizzo 2013), which is 0 only if both have the same distribution and needs no
//! bins. Whether a distance is more than chance is told by a permutation test: the rays of both are shuffled together and
//! dealt out anew, and if they come from the same source, their distance is as likely to be the largest as any other.

use super::hash::split_mix;
use super::{Profile, Query, RayClass, RaySample};
use crate::geom::Aabb;

/// How far two profiles are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// 0: the same distribution, 1: nothing in common. The root of the energy coefficient, so that it grows in proportion to small
    /// moves. Chance alone makes up to about 0.1 of few hundred rays.
    pub distance: f64,
    /// The chance of such a distance, or a larger one, between two samples of the same rays: uniform from 0.005 to 1 if they are.
    pub p_value: f64,
    /// By where rays start alone.
    pub origins: f64,
    /// By their directions alone.
    pub directions: f64,
    /// By how far they get alone.
    pub lengths: f64,
    /// By what they are for and what is asked alone.
    pub kinds: f64,
    /// How many rays of each profile were compared.
    pub rays: [usize; 2],
}

/// So many rays of a profile, the first ones, which are a fair sample: their distances to each other are all needed.
const MOST: usize = 512;
/// How often the rays are mixed.
const MIXES: usize = 199;

impl Profile {
    /// How far `other`'s rays are from these: whether a structure that was built for these still suits. It looks at 512 rays of
    /// each, takes a tenth of a second, and gives the same answer every time. Nothing if one of them holds no rays.
    pub fn drift(&self, other: &Self) -> Option<Drift> {
        let of = |profile: &Self| profile.samples().iter().copied().take(MOST).collect::<Vec<_>>();
        let (mine, theirs) = (of(self), of(other));
        if mine.is_empty() || theirs.is_empty() {
            return None;
        }
        let points = points(&mine, &theirs);
        let rays = [mine.len(), theirs.len()];
        let mut is_mine: Vec<bool> = (0..points.len()).map(|i| i < mine.len()).collect();
        let alone = |part: fn(&Point, &Point) -> f64| {
            Pairs::new(&points, |a, b| part(a, b).sqrt()).coefficient(&is_mine).sqrt()
        };
        let [origins, directions, lengths, kinds] =
            [Point::origins, Point::directions, Point::lengths, Point::kinds].map(alone);
        let pairs = Pairs::new(&points, Point::distance);
        let distance = pairs.coefficient(&is_mine);
        let mut random = Random(1);
        let as_far = (0..MIXES).filter(|_| {
            random.shuffle(&mut is_mine);
            pairs.coefficient(&is_mine) >= distance
        });
        let p_value = (1 + as_far.count()) as f64 / (1 + MIXES) as f64;
        Some(Drift { distance: distance.sqrt(), p_value, origins, directions, lengths, kinds, rays })
    }
}

/// A ray as a point; each part is of about the same size, at most 1 or 2.
#[derive(Debug, Clone, Copy)]
struct Point {
    weight: f64,
    /// In units of the diagonal of all ends.
    origin: [f64; 3],
    /// Of length 1.
    direction: [f64; 3],
    /// In units of the diagonal; at most 2, which stands for infinity.
    length: f64,
    kind: (RayClass, Query),
}

fn points(mine: &[RaySample], theirs: &[RaySample]) -> Vec<Point> {
    let both = || mine.iter().chain(theirs);
    let ends = both().flat_map(|s| [s.ray.origin, s.ray.at(s.t_end())]).filter(|p| p.iter().all(|x| x.is_finite()));
    let diagonal = f64::from(ends.fold(Aabb::EMPTY, Aabb::with).diagonal());
    let size = if diagonal.is_normal() { diagonal } else { 1.0 };
    let point = |s: &RaySample| {
        let d = s.ray.direction.map(f64::from);
        let speed = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        Point {
            weight: f64::from(s.weight),
            origin: s.ray.origin.map(|x| f64::from(x) / size),
            direction: d.map(|x| x / speed),
            length: (f64::from(s.t_end()) * speed / size).clamp(0.0, 2.0),
            kind: (s.class, s.query),
        }
    };
    both().map(point).collect()
}

impl Point {
    /// The Euclidean one of all parts: what makes the energy distance a metric.
    fn distance(&self, other: &Self) -> f64 {
        (self.origins(other) + self.directions(other) + self.lengths(other) + self.kinds(other)).sqrt()
    }

    fn origins(&self, other: &Self) -> f64 {
        squared(self.origin, other.origin)
    }

    fn directions(&self, other: &Self) -> f64 {
        squared(self.direction, other.direction) / 4.0
    }

    fn lengths(&self, other: &Self) -> f64 {
        (self.length - other.length) * (self.length - other.length)
    }

    fn kinds(&self, other: &Self) -> f64 {
        f64::from(u8::from(self.kind != other.kind))
    }
}

fn squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The distances of all pairs of points, times both weights.
struct Pairs {
    weights: Vec<f64>,
    /// Row by row, each from the point after the row's own.
    distances: Vec<f32>,
}

impl Pairs {
    fn new(points: &[Point], distance: impl Fn(&Point, &Point) -> f64) -> Self {
        let row = |i: usize| points[i + 1..].iter().map(move |b| (&points[i], b));
        let weighed = |(a, b): (&Point, &Point)| (distance(a, b) * a.weight * b.weight) as f32;
        let distances = (0..points.len()).flat_map(row).map(weighed).collect();
        Self { weights: points.iter().map(|p| p.weight).collect(), distances }
    }

    /// The energy coefficient of the points that are `mine` and the others: (2 between − within − within) / (2 between), the means
    /// of distances between points of both, and of different points of each. At least 0.
    fn coefficient(&self, is_mine: &[bool]) -> f64 {
        let (mut sums, mut at) = ([0.0f64; 3], 0);
        for (i, &mine) in is_mine.iter().enumerate() {
            let row = &self.distances[at..at + is_mine.len() - 1 - i];
            at += row.len();
            let (mut to_mine, mut all) = (0.0f32, 0.0f32);
            for (&distance, &other) in row.iter().zip(&is_mine[i + 1..]) {
                to_mine += if other { distance } else { 0.0 };
                all += distance;
            }
            let (to_mine, to_others) = (f64::from(to_mine), f64::from(all - to_mine));
            let (same, across) = if mine { (0, to_others) } else { (1, to_mine) };
            sums[same] += if mine { to_mine } else { to_others };
            sums[2] += across;
        }
        let (mut totals, mut squares) = ([0.0; 2], [0.0; 2]);
        for (&weight, &mine) in self.weights.iter().zip(is_mine) {
            totals[usize::from(!mine)] += weight;
            squares[usize::from(!mine)] += weight * weight;
        }
        let within = |side: usize| match totals[side] * totals[side] - squares[side] {
            pairs if pairs > 0.0 => 2.0 * sums[side] / pairs,
            _ => 0.0,
        };
        let between = 2.0 * sums[2] / (totals[0] * totals[1]);
        if between > 0.0 { ((between - within(0) - within(1)) / between).max(0.0) } else { 0.0 }
    }
}

/// A repeatable source of numbers.
struct Random(u64);

impl Random {
    fn shuffle(&mut self, values: &mut [bool]) {
        for i in (1..values.len()).rev() {
            self.0 = split_mix(self.0);
            let below = (u128::from(self.0) * (i as u128 + 1)) >> 64;
            values.swap(i, below as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Ray;

    fn random(seed: u64) -> impl FnMut() -> f32 {
        let mut state = split_mix(seed);
        move || {
            state = split_mix(state);
            (state >> 40) as f32 / (1u64 << 24) as f32
        }
    }

    /// Rays from an eye into a box of size 10.
    fn seen_from(eye: [f32; 3], count: usize, seed: u64) -> Profile {
        let mut unit = random(seed);
        let mut sample = |_| {
            let target = [(); 3].map(|()| 10.0 * unit());
            let ray = Ray::new(eye, [0, 1, 2].map(|a| target[a] - eye[a])).within(0.0, 1.0);
            RaySample::new(ray, None, Query::Closest, RayClass::Primary)
        };
        Profile::from_samples((0..count).map(&mut sample).collect(), seed)
    }

    #[test]
    fn the_same_rays_are_at_no_distance_and_there_is_none_to_nothing() {
        let profile = seen_from([5.0, -5.0, 5.0], 400, 1);
        let same = profile.drift(&profile).unwrap();
        assert_eq!((same.distance, same.rays), (0.0, [400, 400]));
        assert!(same.p_value > 0.5, "{same:?}");
        assert_eq!(profile.drift(&Profile::default()), None);
        assert_eq!(Profile::default().drift(&profile), None);
        let one = profile.clone().thin(1);
        assert!(one.drift(&one).is_some_and(|d| d.distance == 0.0));
        assert!(one.drift(&profile).is_some_and(|d| d.p_value > 0.0 && d.distance.is_finite()));
    }

    #[test]
    fn equal_sources_look_different_as_seldom_as_they_should() {
        let trials = 60;
        let p: Vec<f64> = (0..trials)
            .map(|i| {
                seen_from([5.0, -5.0, 5.0], 100, 2 * i)
                    .drift(&seen_from([5.0, -5.0, 5.0], 100, 2 * i + 1))
                    .unwrap()
                    .p_value
            })
            .collect();
        // 10 % of 60 are 6, with a standard error of 2.3; half of them 30, with one of 3.9.
        let below = |limit: f64| p.iter().filter(|&&p| p <= limit).count();
        assert!(below(0.1) <= 15 && (15..=45).contains(&below(0.5)), "{p:?}");
    }

    #[test]
    fn the_farther_the_camera_moves_the_larger_the_drift() {
        let from = |x: f32, seed| seen_from([5.0 + x, -5.0, 5.0], 600, seed);
        let drifts: Vec<Drift> = [0.0, 0.75, 1.5, 3.0, 5.0].map(|x| from(0.0, 1).drift(&from(x, 2)).unwrap()).into();
        assert!(drifts[0].distance < 0.1 && drifts[0].p_value > 0.01, "{:?}", drifts[0]);
        assert!(drifts[1..].iter().all(|d| d.p_value < 0.01), "{drifts:?}");
        assert!(drifts.windows(2).all(|w| w[0].distance + 0.02 < w[1].distance), "{drifts:?}");
        assert!(drifts.iter().all(|d| d.distance <= 1.0 && d.kinds == 0.0));
        let back = from(3.0, 2).drift(&from(0.0, 1)).unwrap();
        assert!((back.distance - drifts[3].distance).abs() < 1e-6, "{back:?}");
    }

    #[test]
    fn each_part_is_told_apart() {
        let profile = seen_from([5.0, -5.0, 5.0], 300, 1);
        let changed = |change: fn(&mut RaySample)| {
            let mut samples = profile.samples().to_vec();
            samples.iter_mut().for_each(change);
            profile.drift(&Profile::from_samples(samples, 9)).unwrap()
        };
        let shadow = changed(|s| s.class = RayClass::Shadow);
        assert!(shadow.kinds == 1.0 && shadow.origins == 0.0 && shadow.p_value < 0.01, "{shadow:?}");
        let short = changed(|s| s.ray.t_max = 0.2);
        assert!(short.lengths > 0.5 && short.directions == 0.0 && short.kinds == 0.0, "{short:?}");
        let turned = changed(|s| s.ray.direction = s.ray.direction.map(|x| -x));
        assert!(turned.directions > 0.5 && turned.lengths < 1e-6, "{turned:?}");
    }

    #[test]
    fn weights_count_like_repeated_rays() {
        let mut samples = seen_from([5.0, -5.0, 5.0], 200, 1).samples().to_vec();
        let other = seen_from([7.0, -5.0, 5.0], 200, 2);
        let plain = Profile::from_samples(samples.clone(), 1).drift(&other).unwrap();
        samples.iter_mut().for_each(|s| s.weight = 7);
        let heavy = Profile::from_samples(samples, 1).drift(&other).unwrap();
        assert!((plain.distance - heavy.distance).abs() < 1e-3, "{plain:?} {heavy:?}");
    }
}
