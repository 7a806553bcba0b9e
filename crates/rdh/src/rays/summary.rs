//! What a profile holds, in a few figures.

use super::{Profile, Query, RayClass, RaySample};
use crate::geom::{Aabb, Vec3};

/// What a profile holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// One group for each class and query that occur, in that order.
    pub groups: Vec<Group>,
    /// How many rays were recorded.
    pub seen: u64,
    /// How many of them were invalid.
    pub invalid: u64,
    /// The chance that a distinct ray got into the sample.
    pub rate: f64,
    /// The box of all origins; empty without samples.
    pub origins: Aabb,
}

/// The samples of one class and query.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// What the rays were for.
    pub class: RayClass,
    /// What was asked.
    pub query: Query,
    /// How many samples there are.
    pub samples: usize,
    /// How many rays they stand for: the sum of their weights.
    pub weight: u64,
    /// The share of these rays that hit something, 0 to 1.
    pub hit_share: f64,
    /// The box of their origins.
    pub origins: Aabb,
    /// The mean of their normalised directions: of length 1 if all are parallel, near 0 if they go everywhere.
    pub direction_mean: Vec3,
}

impl Profile {
    /// What it holds, in a few figures.
    pub fn summary(&self) -> Summary {
        let kinds = RayClass::ALL.into_iter().flat_map(|class| Query::ALL.map(|query| (class, query)));
        let groups: Vec<_> = kinds.filter_map(|(class, query)| Group::of(class, query, self.samples())).collect();
        Summary {
            seen: self.seen(),
            invalid: self.invalid(),
            rate: self.rate(),
            origins: groups.iter().fold(Aabb::EMPTY, |b, g| b.union(&g.origins)),
            groups,
        }
    }
}

impl Group {
    fn of(class: RayClass, query: Query, samples: &[RaySample]) -> Option<Self> {
        let mine: Vec<_> = samples.iter().filter(|s| s.class == class && s.query == query).collect();
        let weight: u64 = mine.iter().map(|s| u64::from(s.weight)).sum();
        let hits: u64 = mine.iter().filter(|s| s.t_hit.is_some()).map(|s| u64::from(s.weight)).sum();
        let origins = mine.iter().fold(Aabb::EMPTY, |b, s| b.with(s.ray.origin));
        (!mine.is_empty()).then(|| Self {
            class,
            query,
            samples: mine.len(),
            weight,
            hit_share: hits as f64 / weight as f64,
            origins,
            direction_mean: direction_mean(&mine),
        })
    }
}

/// In `f64`, whose range holds the squares of all `f32` lengths.
fn direction_mean(samples: &[&RaySample]) -> Vec3 {
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for s in samples {
        let d = s.ray.direction.map(f64::from);
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let weight = f64::from(s.weight);
        total += weight;
        for axis in 0..3 {
            sum[axis] += weight * d[axis] / length;
        }
    }
    sum.map(|x| (x / total) as f32)
}
