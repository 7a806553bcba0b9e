//! The rows and summaries that `rdh compare --json`, `rdh study` and `rdh merge` speak.
//!
//! The field names are a contract; fields may be added, never renamed.

use rdh::{RayClass, Spec};
use rdh_scene::Kind;
use serde::{Deserialize, Serialize};

use crate::integrate::Mode;
use crate::plan::Protocol;

/// Everything a run found out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// The version of this format: [`Document::VERSION`].
    pub version: u32,
    /// One row per scene, view, frame, mode, class and spec.
    pub rows: Vec<Row>,
    /// One summary per mode, class and spec other than the base.
    pub summary: Vec<Summary>,
    /// What could not be run; absent in JSON if empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<Failure>,
    /// Where two structures gave different answers; absent in JSON if empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mismatches: Vec<Mismatch>,
    /// What a study found that is no row; absent in JSON if empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Curve>,
}

/// What one structure did with the rays of one class in one view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// The frame, 0 at rest.
    pub frame: u32,
    /// How the scene occludes itself.
    pub kind: Kind,
    /// Which integrator made the rays.
    pub mode: Mode,
    /// What the rays are for.
    #[serde(with = "class_text")]
    pub class: RayClass,
    /// The structure.
    pub spec: Spec,
    /// What `auto` chose; absent in JSON for specs that name their structure themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<Spec>,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Rays cast.
    pub rays: u64,
    /// Rays that hit something.
    pub hits: u64,
    /// Sum of the hit distances, in ray order; 0 for rays that only ask whether something is hit.
    pub t_sum: f64,
    /// Rays the structure was built for; 0 if its heuristic needs none.
    pub trained_on: usize,
    /// The view of those rays; null if there are none.
    pub train_view: Option<String>,
    /// The frame of those rays; null if there are none.
    pub train_frame: Option<u32>,
    /// Interior and leaf visits a ray.
    pub steps_per_ray: f64,
    /// Triangles in the leaves visited, a ray; padding is not counted.
    pub tests_per_ray: f64,
    /// Empty leaves visited a ray.
    pub empty_leaves_per_ray: f64,
    /// The 99.9th percentile, over rays, of steps + tests.
    #[serde(default)]
    pub cost_p999: u64,
    /// One thread's CPU time a ray: the median of the rounds.
    pub nanos_per_ray: f64,
    /// The same of each round. Round `i` of all specs of a case ran next to each other.
    pub round_nanos_per_ray: Vec<f64>,
    /// One thread's CPU time of the build: the median if it was repeated.
    pub build_secs: f64,
    /// One thread's CPU time of casting and recording the training rays through the first tree; 0 without training.
    pub rrs_secs: f64,
    /// Interior nodes and leaves.
    pub nodes: usize,
    /// References from leaves to triangles.
    pub references: usize,
    /// Bytes of the structure and its copies of triangles.
    pub bytes: usize,
    /// The longest way from the root to a leaf, in edges.
    pub depth: usize,
    /// How the training rays were chosen.
    pub protocol: Protocol,
    /// The plan's seed.
    pub seed: u64,
    /// The experiment of a study that asked for it; absent in JSON for plain comparisons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub experiment: Option<String>,
    /// Under which of the experiment's settings, in words; rows of one setting are paired and summarised together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub setting: Option<String>,
    /// The setting's place on the experiment's axis, where it has one: training rays, frames of distance, a weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Mean number of surfaces that a ray would cross if it weren't stopped: the measured depth complexity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_complexity: Option<f64>,
}

/// Points of a named quantity over another, found in one view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The experiment.
    pub experiment: String,
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// Which integrator made the rays.
    pub mode: Mode,
    /// What is measured, under which setting: `p measured / p estimated, uniform whole`.
    pub name: String,
    /// The structure it was measured on.
    pub spec: Spec,
    /// The quantity across: `depth`, `rays`.
    pub across: String,
    /// `[x, y, weight]`; a weighted mean over scenes uses the weights. Times don't belong here: curves are exact.
    pub points: Vec<[f64; 3]>,
}

/// Over which pairs a summary goes, and how they weigh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Over {
    /// All pairs alike.
    #[default]
    Pairs,
    /// Those of one kind of scene.
    Kind(Kind),
    /// All pairs, weighed so that each kind of scene counts the same.
    Kinds,
}

/// A spec against the base over all scenes and views. Ratios are geometric means of spec / base: below 1 is better.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The study's experiment; absent in JSON for plain comparisons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub experiment: Option<String>,
    /// Under which of the experiment's settings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub setting: Option<String>,
    /// The setting's place on the experiment's axis, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Over which pairs, and how they weigh.
    #[serde(default)]
    pub over: Over,
    /// Which integrator made the rays.
    pub mode: Mode,
    /// The class of the rays; `None`, in JSON `"all"`, for all classes of the mode together.
    #[serde(with = "class_or_all_text")]
    pub class: Option<RayClass>,
    /// The structure.
    pub spec: Spec,
    /// What it is compared with.
    pub base: Spec,
    /// How many pairs: scenes × views × frames (× seeds) that have both.
    pub n: usize,
    /// Interior and leaf visits.
    pub steps_ratio: f64,
    /// A 95 % interval of `steps_ratio`, bootstrapped with the scene as cluster.
    pub steps_ratio_ci95: [f64; 2],
    /// Triangles tested.
    pub tests_ratio: f64,
    /// A 95 % interval of `tests_ratio`.
    pub tests_ratio_ci95: [f64; 2],
    /// The 99.9th percentile, over rays, of steps + tests; of several classes the worst.
    pub cost_p999_ratio: f64,
    /// Time a ray.
    pub time_ratio: f64,
    /// A 95 % interval of `time_ratio`, bootstrapped with the scene as cluster.
    pub time_ratio_ci95: [f64; 2],
    /// Build time, without the acquisition of the training rays.
    pub build_ratio: f64,
    /// Build time and acquisition of the training rays.
    pub build_and_rrs_ratio: f64,
    /// References to triangles.
    pub references_ratio: f64,
    /// Memory.
    pub bytes_ratio: f64,
    /// Pairs whose own 95 % interval lies wholly above 1.
    pub slower_cases: usize,
    /// Pairs whose own interval lies wholly below 1.
    pub faster_cases: usize,
}

/// Something that could not be run. The other cases were.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// The scene's id.
    pub scene: String,
    /// The view, if only one was concerned.
    pub view: Option<String>,
    /// The structure, if only one was concerned.
    pub spec: Option<Spec>,
    /// What went wrong.
    pub reason: String,
}

/// Two structures that don't agree: a bug of one of them, so that none of their times count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mismatch {
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// Which integrator made the rays.
    pub mode: Mode,
    /// What the rays are for.
    #[serde(with = "class_text")]
    pub class: RayClass,
    /// The structure.
    pub spec: Spec,
    /// What it was compared with.
    pub base: Spec,
    /// How many rays got different answers.
    pub rays: u64,
    /// The first of them: its index in the batch.
    pub first_ray: usize,
    /// That ray as `[ox, oy, oz, dx, dy, dz]`, bit for bit what was cast.
    pub ray: [f32; 6],
    /// The last `t` that counted for it; null if unlimited.
    pub t_max: Option<f32>,
    /// What the structure said: distance and triangle, or null for a miss.
    pub answer: Option<(f32, u32)>,
    /// What the base said.
    pub base_answer: Option<(f32, u32)>,
}

/// How a run ended, worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Structures disagree.
    Mismatch,
    /// Something could not be run.
    Failed,
    /// All is well.
    Fine,
}

impl Row {
    /// The row without what a clock said: equal for equal plans.
    pub fn without_times(&self) -> Self {
        let timeless = Self { nanos_per_ray: 0.0, round_nanos_per_ray: Vec::new(), ..self.clone() };
        Self { build_secs: 0.0, rrs_secs: 0.0, ..timeless }
    }
}

impl Document {
    /// The version this program writes.
    pub const VERSION: u32 = 1;

    /// The document as JSON, in one line.
    ///
    /// # Errors
    /// What serde says.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// Reads a document; all numbers are what they were when it was written.
    ///
    /// # Errors
    /// Malformed JSON, missing fields, unknown names: with line and column.
    pub fn from_json(text: &str) -> serde_json::Result<Self> {
        let document: Self = serde_json::from_str(text)?;
        if document.version != Self::VERSION {
            let (got, known) = (document.version, Self::VERSION);
            return Err(serde::de::Error::custom(format!("version {got} of the format; only {known} can be read")));
        }
        Ok(document)
    }

    /// How the run ended.
    pub fn verdict(&self) -> Verdict {
        if !self.mismatches.is_empty() {
            Verdict::Mismatch
        } else if !self.failures.is_empty() {
            Verdict::Failed
        } else {
            Verdict::Fine
        }
    }
}

impl Verdict {
    /// The program's exit code: 0 fine, 1 failed, 3 a verification failed.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::Failed => 1,
            Self::Mismatch => 3,
        }
    }
}

/// A class by its name.
mod class_text {
    use rdh::RayClass;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(class: &RayClass, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(class.name())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<RayClass, D::Error> {
        parse(&String::deserialize(d)?).map_err(serde::de::Error::custom)
    }

    pub(super) fn parse(name: &str) -> Result<RayClass, String> {
        let known = || RayClass::ALL.map(RayClass::name).join(", ");
        let found = RayClass::ALL.into_iter().find(|c| c.name() == name);
        found.ok_or_else(|| format!("unknown class '{name}'; known: {}", known()))
    }
}

/// A class by its name, or "all".
mod class_or_all_text {
    use rdh::RayClass;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(class: &Option<RayClass>, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(class.map_or("all", RayClass::name))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<Option<RayClass>, D::Error> {
        let name = String::deserialize(d)?;
        if name == "all" {
            return Ok(None);
        }
        super::class_text::parse(&name).map(Some).map_err(serde::de::Error::custom)
    }
}
