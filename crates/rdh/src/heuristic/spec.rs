//! Heuristics as plain data, with the same text everywhere: `sah`, `rdh`, `rdh(paper)`, `rdh(prior=32,rays=whole)`.

use serde::{Deserialize, Serialize};

/// Which heuristic, with its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum HeuristicSpec {
    /// Surface areas: uniform rays that never hit anything.
    #[default]
    Sah,
    /// Sampled rays, blended with surface areas.
    Rdh(RdhSpec),
}

/// Parameters of the ray distribution heuristic.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RdhSpec {
    /// How much of a sampled ray counts.
    pub rays: RayExtent,
    /// How ray counts and areas are mixed.
    pub blend: Blend,
    /// Counts at most so many rays in a node (a random sub-sample); 0 counts all.
    /// `None` is what suits the structure: 4,096 in a kd-tree, 64 in a BVH, whose nodes hold more.
    pub cap: Option<u32>,
    /// What a hierarchy takes from the rays. A kd-tree has none of these stages.
    pub stages: Stages,
}

/// What decides each stage of a hierarchy's build: to see what a stage gains, give it back to the areas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Stages {
    /// Where nodes are split.
    pub splits: By,
    /// Which subtrees are moved afterwards, and where to.
    pub moves: By,
    /// How the binary tree is cut into wide nodes.
    pub cuts: By,
    /// In which order any-hit rays try a node's children.
    pub order: By,
}

/// What decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum By {
    /// The sampled rays, and areas as far as these are few.
    #[default]
    Rays,
    /// Areas alone.
    Areas,
}

/// How much of a sampled ray counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum RayExtent {
    /// From its start to where it ended: the cells that a query really visits.
    Clipped,
    /// The whole half-line, as if nothing were hit.
    Whole,
}

/// How ray counts and areas are mixed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Blend {
    /// `p = (prior · p_sah + n · p_rays) / (prior + n)`: the areas count as so many rays.
    Confidence {
        /// How many rays the areas are worth.
        prior: f32,
    },
    /// `w = weight · (1 − 1/(1 + 0.1 n))`, `p = w · p_rays + (1 − w) · p_sah`: as attributed to the paper.
    Paper {
        /// The largest weight of the rays; 0.9 in the paper's attributed form.
        weight: f32,
    },
}

impl HeuristicSpec {
    /// Whether subtrees are pruned by measured visits unless the spec says otherwise. The paper's heuristic is
    /// pruned as its baseline is.
    pub(crate) fn prunes_by_visits(&self) -> bool {
        matches!(self, Self::Rdh(RdhSpec { blend: Blend::Confidence { .. }, .. }))
    }
}

impl Stages {
    /// All of them.
    pub const BY_RAYS: Self = Self { splits: By::Rays, moves: By::Rays, cuts: By::Rays, order: By::Rays };

    /// Their names in specs, in the order of the build.
    pub(crate) const NAMES: [&'static str; 4] = ["splits", "moves", "cuts", "order"];

    /// The stage of a name.
    pub(crate) fn get_mut(&mut self, name: &str) -> Option<&mut By> {
        match name {
            "splits" => Some(&mut self.splits),
            "moves" => Some(&mut self.moves),
            "cuts" => Some(&mut self.cuts),
            "order" => Some(&mut self.order),
            _ => None,
        }
    }
}

impl RdhSpec {
    /// The paper's: whole rays, no cap, its blend.
    pub const PAPER: Self =
        Self { rays: RayExtent::Whole, blend: Blend::Paper { weight: 0.9 }, cap: Some(0), stages: Stages::BY_RAYS };
}

impl Default for RdhSpec {
    fn default() -> Self {
        Self {
            rays: RayExtent::Clipped,
            blend: Blend::Confidence { prior: 16.0 },
            cap: None,
            stages: Stages::default(),
        }
    }
}
