//! What is tried unless the caller says otherwise: one list, each entry with its reason.

use crate::spec::Spec;

/// A structure worth trying.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Candidate {
    /// Its spec, as text.
    pub spec: &'static str,
    /// When it wins.
    pub why: &'static str,
}

/// What is tried unless the caller says otherwise. The first one is what is kept where there are too few rays to choose.
pub const CANDIDATES: &[Candidate] = &[
    Candidate {
        spec: "bvh8+sah",
        why: "no rays needed, fast to build, within a few per cent of the best on open scenes",
    },
    Candidate { spec: "bvh8(high)+sah", why: "what more effort gives without rays: what rays must beat" },
    Candidate { spec: "sbvh8(high)+sah", why: "large or long triangles, whose boxes would overlap" },
    Candidate {
        spec: "bvh4+sah",
        why: "rays that visit few nodes: narrow nodes are cheaper where eight boxes can't be tested at once",
    },
    Candidate { spec: "kd+sah", why: "many overlapping objects and high depth complexity" },
    Candidate { spec: "bvh8+rdh", why: "occluded scenes, any-hit rays: the usual winner for its build time" },
    Candidate { spec: "bvh8(high)+rdh", why: "the same, for scenes that stay: short any-hit rays gain most" },
    Candidate { spec: "sbvh8(high)+rdh", why: "large triangles in occluded scenes" },
    Candidate { spec: "bvh4+rdh", why: "as bvh4+sah, for rays that are known" },
    Candidate { spec: "kd+rdh", why: "rays from one place in scenes of high depth complexity" },
];

impl Spec {
    /// What [`tune`](crate::tune()) tries unless told otherwise: [`CANDIDATES`], in order.
    pub fn candidates() -> Vec<Self> {
        CANDIDATES.iter().map(|c| c.spec.parse().expect("a test parses the whole list")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_are_in_their_shortest_form_and_begin_with_one_that_needs_no_rays() {
        let specs = Spec::candidates();
        assert!(specs.iter().zip(CANDIDATES).all(|(spec, c)| spec.to_string() == c.spec && !c.why.is_empty()));
        assert!(!specs[0].needs_rays() && specs.iter().any(Spec::needs_rays));
    }
}
