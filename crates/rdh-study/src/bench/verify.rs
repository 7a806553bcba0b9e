//! Answers compared ray by ray, before any time counts.

use rdh::{Accel, Hit, Query, Ray};

/// Fewer different answers than this are forgiven others in columns of few hits.
const FORGIVEN: u64 = 4;

/// Distances that differ by no more than this part of themselves are the same: other libraries round otherwise, and
/// neighbouring triangles meet at edges.
const SAME_T: f32 = 1e-3;

/// All answers of one of our structures, or of its twin.
#[derive(Debug)]
pub(crate) struct Answers {
    /// Distances as engines give them: infinite for a miss, 0 for an occlusion.
    pub(crate) t: Vec<f32>,
    /// Which triangle; nothing where that isn't asked.
    ids: Vec<u32>,
}

/// How answers differ from those of our first structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Difference {
    /// Hits there, none here.
    pub(crate) lost: u64,
    /// Hits here, none there.
    pub(crate) extra: u64,
    /// Hits in both, at different distances; among ours also of different triangles.
    pub(crate) differ: u64,
}

impl Answers {
    /// Casts all rays through one of ours.
    pub(crate) fn of(accel: &Accel, rays: &[Ray], query: Query) -> Self {
        Self::given(rays, query, (|ray: &Ray| accel.closest(ray), |ray: &Ray| accel.occluded(ray)))
    }

    /// What is given for all rays by the nearest hit, or by whether there is any.
    pub(crate) fn given(
        rays: &[Ray],
        query: Query,
        (closest, occluded): (impl Fn(&Ray) -> Option<Hit>, impl Fn(&Ray) -> bool),
    ) -> Self {
        if query == Query::Occluded {
            return Self::of_occlusions(&rays.iter().map(occluded).collect::<Vec<_>>());
        }
        Self::of_hits(&rays.iter().map(closest).collect::<Vec<_>>())
    }

    /// Casts all rays through one of ours at once.
    pub(crate) fn of_batch(accel: &Accel, rays: &[Ray], query: Query) -> Self {
        if query == Query::Occluded {
            let mut occluded = vec![false; rays.len()];
            accel.occluded_many(rays, &mut occluded);
            return Self::of_occlusions(&occluded);
        }
        let mut hits = vec![None; rays.len()];
        accel.closest_many(rays, &mut hits);
        Self::of_hits(&hits)
    }

    fn of_occlusions(occluded: &[bool]) -> Self {
        let t = occluded.iter().map(|is| if *is { 0.0 } else { f32::INFINITY }).collect();
        Self { t, ids: Vec::new() }
    }

    fn of_hits(hits: &[Option<Hit>]) -> Self {
        let t = hits.iter().map(|hit| hit.map_or(f32::INFINITY, |h| h.t)).collect();
        let ids = hits.iter().map(|hit| hit.map_or(u32::MAX, |h| h.tri.0)).collect();
        Self { t, ids }
    }

    /// How many rays hit something.
    pub(crate) fn hits(&self) -> u64 {
        count(self.t.iter().map(|t| *t < f32::INFINITY))
    }

    /// How another of ours differs: every bit counts.
    pub(crate) fn exactly(&self, other: &Self) -> Difference {
        let mut difference = compare(&self.t, &other.t, |a, b| a.to_bits() == b.to_bits());
        let other_id = self.ids.iter().zip(&other.ids).zip(self.t.iter().zip(&other.t));
        difference.differ += count(other_id.map(|((i, j), (a, b))| a.to_bits() == b.to_bits() && i != j));
        difference
    }

    /// How another library's answers differ.
    pub(crate) fn nearly(&self, other: &[f32]) -> Difference {
        compare(&self.t, other, |a, b| (a - b).abs() <= SAME_T * a.abs())
    }
}

impl Difference {
    /// Whether another library's answers may differ so much, at a share of our hits.
    pub(crate) fn is_tolerable(&self, hits: u64, share: f64) -> bool {
        self.total() as f64 <= (share * hits as f64).max(FORGIVEN as f64)
    }

    /// Rays that are answered differently.
    pub(crate) fn total(&self) -> u64 {
        self.lost + self.extra + self.differ
    }
}

fn compare(ours: &[f32], theirs: &[f32], same: impl Fn(f32, f32) -> bool) -> Difference {
    let mut difference = Difference::default();
    for (&a, &b) in ours.iter().zip(theirs) {
        // NaN is no answer: it counts as a miss.
        match (a < f32::INFINITY, b < f32::INFINITY) {
            (true, false) => difference.lost += 1,
            (false, true) => difference.extra += 1,
            (true, true) => difference.differ += u64::from(!same(a, b)),
            (false, false) => {}
        }
    }
    difference
}

fn count(flags: impl Iterator<Item = bool>) -> u64 {
    flags.map(u64::from).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MISS: f32 = f32::INFINITY;

    fn ours() -> Answers {
        Answers { t: vec![1.0, 2.0, MISS, 4.0, MISS], ids: vec![7, 8, u32::MAX, 9, u32::MAX] }
    }

    #[test]
    fn ours_must_agree_in_every_bit() {
        let change = |change: fn(&mut Answers)| {
            let mut other = ours();
            change(&mut other);
            ours().exactly(&other).total()
        };
        assert_eq!(change(|_| ()), 0);
        assert_eq!(change(|a| a.t[0] = 1.000_000_1), 1);
        assert_eq!(change(|a| a.ids[3] = 8), 1);
        assert_eq!(change(|a| a.t[1] = MISS), 1);
    }

    #[test]
    fn others_must_agree_nearly() {
        let difference = ours().nearly(&[1.0005, MISS, 3.0, 4.1, f32::NAN]);
        assert_eq!(difference, Difference { lost: 1, extra: 1, differ: 1 });
        assert_eq!(ours().nearly(&[f32::NAN, 2.0, MISS, 4.0, MISS]).lost, 1);
    }

    #[test]
    fn the_tolerance_is_a_share_of_hits_but_a_handful_is_forgiven() {
        let lost = |lost| Difference { lost, ..Difference::default() };
        assert!(lost(1000).is_tolerable(1_000_000, 0.001) && !lost(1001).is_tolerable(1_000_000, 0.001));
        assert!(lost(4).is_tolerable(10, 0.001) && !lost(5).is_tolerable(10, 0.001));
    }
}
