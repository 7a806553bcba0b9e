//! What was tried and why one was taken: plain data, to be printed, saved with the tree, and checked again.

use serde::{Deserialize, Serialize};

use crate::rays::{Query, RayClass};
use crate::spec::Spec;

/// What was tried, and why one was taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// The version of this format: [`Evidence::VERSION`].
    pub version: u32,
    /// What was taken.
    pub spec: Spec,
    /// The best structure that needs no rays.
    pub base: Spec,
    /// How the choice ended.
    pub outcome: Outcome,
    /// Why, in a sentence.
    pub reason: String,
    /// By what the last decision was made.
    pub measure: Measure,
    /// The chance to take a slower structure than the best one by areas, over all that were tried together.
    pub risk: f64,
    /// By so much the winner had to be faster at least.
    pub margin: f64,
    /// Candidates that know the rays: so many times could chance have had its way.
    pub tried: usize,
    /// The rays it was decided on.
    pub rays: RaysUsed,
    /// What became of each candidate, in the order in which they were given.
    pub trials: Vec<Trial>,
}

/// How a choice ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A structure for the rays is surely faster than all by areas.
    Rays,
    /// No structure for the rays is surely faster: the best one by areas is kept.
    Areas,
    /// There were too few rays to choose by: the first candidate by areas is kept.
    TooFewRays,
}

/// What costs are measured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Steps and tests, weighed by stored costs.
    Counts,
    /// The clock.
    Time,
}

/// The rays a choice is made by.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RaysUsed {
    /// Distinct training rays that could be used.
    pub training: usize,
    /// Distinct held-out rays that could be used.
    pub held_out: usize,
    /// Rays of both sets that were of no use: invalid, or of no weight.
    pub dropped: usize,
    /// As many equal held-out rays would say as much.
    pub effective: f64,
    /// Blocks of held-out rays, over which the statistics are.
    pub blocks: usize,
}

/// What became of a candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The candidate.
    pub spec: Spec,
    /// Why it could not be built, or was not tried; absent if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// How long its build took, by the clock.
    pub build_secs: Option<f64>,
    /// Bytes of the structure.
    pub bytes: Option<usize>,
    /// Interior and leaf visits a held-out ray.
    pub steps_per_ray: Option<f64>,
    /// Triangles tested a held-out ray.
    pub tests_per_ray: Option<f64>,
    /// What a training ray costs, by counts.
    pub training_nanos_per_ray: Option<f64>,
    /// The rungs it ran on, in order.
    pub rungs: Vec<Rung>,
    /// The last rung's costs against the base, for those that came so far and know the rays.
    pub comparison: Option<Comparison>,
    /// Its gain on the training rays that is lost on held-out ones: the ratio to the base by counts there, divided by that here.
    /// 1: nothing was learnt by heart.
    pub gap: Option<f64>,
    /// After so many rays its build has paid for what it took longer than the base's; 0 if it didn't. Nothing if it never does, or no
    /// clock says so.
    pub break_even_rays: Option<f64>,
}

/// A rung of the race.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rung {
    /// What counted.
    pub measure: Measure,
    /// What a held-out ray cost: by stored costs of steps and tests, or by the clock.
    pub nanos_per_ray: f64,
    /// Whether it went on.
    pub kept: bool,
}

/// A structure's cost against another one's, on the same rays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The other one.
    pub base: Spec,
    /// By what.
    pub measure: Measure,
    /// Cost over the base's cost: below 1 is better.
    pub ratio: f64,
    /// An interval of it, which holds those of both sessions of times; nothing if there is no bound.
    pub interval: Option<[f64; 2]>,
    /// The risk that the truth is beyond it, for each end. It is the choice's risk divided by all that were tried, so that all
    /// ends together hold at the choice's risk.
    pub interval_risk: f64,
    /// The chance to look so much faster without being so, by the margin at least: the largest over both sessions and all structures
    /// by areas that came so far, and for those of its own kind over steps and tests as well.
    pub p_faster: f64,
    /// The chance to look so much slower than the base without being so.
    pub p_slower: f64,
    /// The same for each class and query alone.
    pub classes: Vec<ClassRatio>,
}

/// A ratio of costs for the rays of one class.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ClassRatio {
    /// What the rays are for.
    pub class: RayClass,
    /// What is asked of them.
    pub query: Query,
    /// Distinct rays.
    pub rays: usize,
    /// Cost over the base's cost.
    pub ratio: f64,
    /// An interval of it, as that of all.
    pub interval: Option<[f64; 2]>,
}

impl Evidence {
    /// The version of the format.
    pub const VERSION: u32 = 1;

    /// What became of the structure that was taken.
    pub fn taken(&self) -> Option<&Trial> {
        self.trials.iter().find(|trial| trial.spec == self.spec)
    }
}

impl Trial {
    pub(super) fn of(spec: Spec) -> Self {
        Self {
            spec,
            error: None,
            build_secs: None,
            bytes: None,
            steps_per_ray: None,
            tests_per_ray: None,
            training_nanos_per_ray: None,
            rungs: Vec::new(),
            comparison: None,
            gap: None,
            break_even_rays: None,
        }
    }

    /// What a held-out ray costs on the last rung of a kind.
    pub fn nanos_per_ray(&self, measure: Measure) -> Option<f64> {
        self.rungs.iter().rfind(|rung| rung.measure == measure).map(|rung| rung.nanos_per_ray)
    }
}
