//! What finished structures do with batches of rays: exact counts, answers, and times.

use std::hint::black_box;

use rayon::prelude::*;
use rdh::{Accel, Counts, Query, Ray};

use crate::clock::time_thread;
use crate::integrate::RayBatch;

/// The answer to one ray: distance and triangle; a ray that only asks whether anything is hit has neither.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Answer {
    /// Bits of the distance: answers must be equal bit for bit.
    t_bits: u32,
    tri: u32,
}

/// What a structure did with a batch.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// What it cost.
    pub counts: Counts,
    /// Rays that hit something.
    pub hits: u64,
    /// Sum of the hit distances, in ray order; 0 for any-hit rays.
    pub t_sum: f64,
    /// The 99.9th percentile, over rays, of steps + tests: the smallest cost that 99.9 % of the rays don't exceed.
    pub cost_p999: u64,
    /// Every ray's answer, in ray order.
    pub answers: Vec<Answer>,
}

/// Where two tallies of the same batch differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Difference {
    /// How many rays got different answers.
    pub rays: u64,
    /// The index of the first of them.
    pub first: usize,
}

impl Answer {
    const MISS: Self = Self { t_bits: u32::MAX, tri: u32::MAX };
    const OCCLUDED: Self = Self { t_bits: 0, tri: u32::MAX };

    /// Distance and triangle of a closest hit.
    pub fn hit(self) -> Option<(f32, u32)> {
        (self.tri != u32::MAX).then(|| (f32::from_bits(self.t_bits), self.tri))
    }

    /// Whether anything was hit.
    pub fn is_hit(self) -> bool {
        self != Self::MISS
    }
}

/// Casts a batch once and counts everything. Runs on rayon's current threads; the result doesn't depend on how many.
pub fn tally(accel: &Accel, batch: &RayBatch) -> Tally {
    let chunk = |rays: &[Ray]| {
        let mut total = Counts::default();
        let mut cast = |ray: &Ray| {
            let mut counts = Counts::default();
            let answer = answer(accel, batch.query, ray, &mut counts);
            total += counts;
            (answer, counts.steps() + counts.tests)
        };
        let (answers, costs): (Vec<Answer>, Vec<u64>) = rays.iter().map(&mut cast).unzip();
        (total, answers, costs)
    };
    let chunks: Vec<_> = batch.rays.par_chunks(4096).map(chunk).collect();
    let (mut counts, mut answers, mut costs) = (Counts::default(), Vec::with_capacity(batch.rays.len()), Vec::new());
    for (count, answer, cost) in chunks {
        counts += count;
        answers.extend(answer);
        costs.extend(cost);
    }
    let hits = answers.iter().filter(|a| a.is_hit()).count() as u64;
    // One after the other: a sum of floats depends on its order.
    let t_sum = answers.iter().filter_map(|a| a.hit()).fold(0.0, |sum, (t, _)| sum + f64::from(t));
    Tally { counts, hits, t_sum, cost_p999: worst_but_a_thousandth(costs), answers }
}

fn worst_but_a_thousandth(mut costs: Vec<u64>) -> u64 {
    let Some(last) = costs.len().checked_sub(1) else { return 0 };
    let rank = last - costs.len() / 1000;
    *costs.select_nth_unstable(rank).1
}

/// Modes ask for all hits of no ray; if a batch does, its nearest ones are counted.
fn answer(accel: &Accel, query: Query, ray: &Ray, counts: &mut Counts) -> Answer {
    match query {
        Query::Occluded if accel.occluded_counted(ray, counts) => Answer::OCCLUDED,
        Query::Occluded => Answer::MISS,
        Query::Closest | Query::All => match accel.closest_counted(ray, counts) {
            Some(hit) => Answer { t_bits: hit.t.to_bits(), tri: hit.tri.0 },
            None => Answer::MISS,
        },
    }
}

/// Where `tally` differs from `base`, if anywhere.
pub fn difference(tally: &Tally, base: &Tally) -> Option<Difference> {
    let mut different =
        tally.answers.iter().zip(&base.answers).enumerate().filter(|(_, (a, b))| a != b).map(|(i, _)| i);
    let first = different.next()?;
    Some(Difference { rays: 1 + different.count() as u64, first })
}

/// Seconds of each structure, batch and round, as `[structure][batch][round]`: one thread's CPU time.
///
/// In each round every structure casts all batches in turn, and the order of structures is rotated from round to round,
/// so that whatever drifts (clock speed, neighbours on the machine) meets all alike.
pub fn time_interleaved(accels: &[&Accel], batches: &[RayBatch], rounds: usize) -> Vec<Vec<Vec<f64>>> {
    let mut secs = vec![vec![Vec::with_capacity(rounds); batches.len()]; accels.len()];
    for round in 0..rounds {
        for turn in 0..accels.len() {
            let which = (turn + round) % accels.len();
            for (batch, secs) in batches.iter().zip(&mut secs[which]) {
                secs.push(cast_secs(accels[which], batch));
            }
        }
    }
    secs
}

/// CPU seconds of this thread for casting a batch the way users do.
pub(crate) fn cast_secs(accel: &Accel, batch: &RayBatch) -> f64 {
    let (_, secs) = time_thread(|| match batch.query {
        Query::Occluded => {
            black_box(batch.rays.iter().filter(|ray| accel.occluded(ray)).count());
        }
        Query::Closest | Query::All => {
            // The sum keeps the compiler from dropping what nobody reads.
            black_box(batch.rays.iter().filter_map(|ray| accel.closest(ray)).map(|hit| hit.t).sum::<f32>());
        }
    });
    secs
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::{BuildOptions, Mesh, RayClass, Spec, Training};

    /// Two triangles at z = 1 and z = 2, or only the first.
    fn accel(triangles: u32) -> Accel {
        let corners = |z: f32| [[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]];
        let positions = [corners(1.0), corners(2.0)].concat();
        let mesh = Mesh::new(positions, (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
        rdh::build(&mesh, &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap()
    }

    fn batch(query: Query) -> RayBatch {
        // At the first triangle, from between them at the second, away from both.
        let starts = [([0.0, 0.0, 0.0], 1.0), ([0.0, 0.0, 1.5], 1.0), ([0.0, 0.0, 0.0], -1.0)];
        let rays = starts.map(|(origin, dz)| Ray::new(origin, [0.0, 0.0, dz])).to_vec();
        RayBatch { class: RayClass::Primary, query, rays }
    }

    #[test]
    fn a_tally_sums_hits_and_distances() {
        let closest = tally(&accel(2), &batch(Query::Closest));
        assert_eq!((closest.hits, closest.t_sum), (2, 1.5));
        let found: Vec<_> = closest.answers.iter().map(|a| a.hit()).collect();
        assert_eq!(found, [Some((1.0, 0)), Some((0.5, 1)), None]);
        assert_eq!(closest.cost_p999, worst_but_a_thousandth(vec![closest.cost_p999]));
        assert!(closest.cost_p999 <= closest.counts.steps() + closest.counts.tests);
        assert!(closest.counts.steps() >= 2 && closest.counts.tests >= 2);
        let any = tally(&accel(2), &batch(Query::Occluded));
        assert_eq!((any.hits, any.t_sum), (2, 0.0));
    }

    #[test]
    fn one_in_a_thousand_may_cost_more() {
        let costs = |n: u64| (0..n).rev().collect::<Vec<u64>>();
        assert_eq!([0, 1, 999, 1000, 5000].map(|n| worst_but_a_thousandth(costs(n))), [0, 0, 998, 998, 4994]);
    }

    #[test]
    fn a_lost_triangle_is_a_difference_and_its_ray_is_named() {
        for query in [Query::Closest, Query::Occluded] {
            let [good, bad] = [2, 1].map(|n| tally(&accel(n), &batch(query)));
            assert_eq!(difference(&good, &good), None);
            assert_eq!(difference(&bad, &good), Some(Difference { rays: 1, first: 1 }));
        }
    }

    #[test]
    fn every_round_times_every_structure_and_batch() {
        let (a, b) = (accel(2), accel(1));
        let secs = time_interleaved(&[&a, &b], &[batch(Query::Closest), batch(Query::Occluded)], 3);
        assert!(secs.len() == 2 && secs.iter().all(|s| s.len() == 2 && s.iter().all(|rounds| rounds.len() == 3)));
        assert!(secs.iter().flatten().flatten().all(|&s| (0.0..1.0).contains(&s)));
    }
}
