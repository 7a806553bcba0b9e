//! Which structure the next frame gets: whichever would have taken least for the last frames' rays.

/// What a frame has cost with one structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Seconds before the first ray: the profile and the build.
    pub before_secs: f64,
    /// Nanoseconds a ray, with what grew meanwhile.
    pub nanos_per_ray: f64,
}

/// What is known of some candidates from earlier frames. A candidate is known by having been used: each gets one frame first, in order,
/// so that what is found out is paid for; then the cheapest is used, and learnt anew with every frame. One that surely takes longer than
/// a known one is not tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    known: Vec<Option<Cost>>,
    /// Seconds that each takes at least.
    least: Vec<f64>,
}

impl Choice {
    /// Among so many candidates, at least one, of which nothing is known.
    pub fn among(candidates: usize) -> Self {
        Self::with_least(vec![0.0; candidates.max(1)])
    }

    /// Among as many candidates as there are numbers, at least one: seconds that a frame takes with each at least.
    pub fn with_least(least: Vec<f64>) -> Self {
        Self { known: vec![None; least.len()], least }
    }

    /// Which candidate is to be used for a frame of so many rays.
    pub fn next(&self, rays: u64) -> usize {
        let secs = |i: usize| self.known[i].map_or(f64::INFINITY, |cost| cost.secs(rays));
        let cheapest = (0..self.known.len()).min_by(|&a, &b| secs(a).total_cmp(&secs(b))).unwrap_or(0);
        let may_pay = |i: &usize| self.known[*i].is_none() && self.least[*i] < secs(cheapest);
        (0..self.known.len()).find(may_pay).unwrap_or(cheapest)
    }

    /// Learns what a frame has cost with a candidate.
    ///
    /// # Panics
    /// If there is no such candidate.
    pub fn learn(&mut self, candidate: usize, cost: Cost) {
        self.known[candidate] = Some(cost);
    }
}

impl Cost {
    /// What a frame of so many rays would take.
    pub fn secs(&self, rays: u64) -> f64 {
        self.before_secs + self.nanos_per_ray * 1e-9 * rays as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_tried_once_and_then_the_cheapest_for_the_number_of_rays() {
        let mut choice = Choice::among(2);
        let eager = Cost { before_secs: 1.0, nanos_per_ray: 100.0 };
        let lazy = Cost { before_secs: 0.1, nanos_per_ray: 200.0 };
        assert_eq!(choice.next(1), 0);
        choice.learn(0, eager);
        assert_eq!(choice.next(1), 1);
        choice.learn(1, lazy);
        // They break even at nine million rays.
        assert_eq!((choice.next(8_000_000), choice.next(10_000_000)), (1, 0));
        // The scene has opened: everything is reached.
        choice.learn(1, Cost { before_secs: 0.1, nanos_per_ray: 2000.0 });
        assert_eq!(choice.next(1_000_000), 0);
    }

    #[test]
    fn what_surely_takes_longer_is_not_tried() {
        let mut choice = Choice::with_least(vec![0.0, 0.2]);
        assert_eq!(choice.next(1_000_000), 0);
        choice.learn(0, Cost { before_secs: 0.0, nanos_per_ray: 100.0 });
        assert_eq!(choice.next(1_000_000), 0);
        // There are more rays: it may pay now.
        assert_eq!(choice.next(3_000_000), 1);
    }
}
