//! What is found out, as plain data: the JSON of `rdh bench`, and the lines of its log.

use rdh::Spec;
use serde::{Deserialize, Serialize};

use super::columns::Column;
use super::plan::BenchPlan;
use super::registry::Form;

/// The whole of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchDocument {
    /// Of this form; 1.
    pub version: u32,
    /// What the figures depend on.
    pub settings: Settings,
    /// Per scene, column and engine.
    pub rows: Vec<BenchRow>,
    /// Ours against each base, over all scenes.
    pub summary: Vec<BenchSummary>,
    /// What builds cost, over all scenes.
    pub builds: Vec<BuildSummary>,
    /// Competitors that aren't there.
    pub skipped: Vec<Skipped>,
    /// What could not be measured.
    pub failures: Vec<BenchFailure>,
}

/// What the figures depend on. A log of other settings is not continued.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Our structures.
    pub specs: Vec<Spec>,
    /// The instructions that they were traced with, where they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<String>,
    /// Of which of them leaky twins race.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin: Option<Spec>,
    /// Competitors that were asked for.
    pub engines: Vec<String>,
    /// Kinds of rays.
    pub columns: Vec<Column>,
    /// Pixels of the film, across and down.
    pub size: usize,
    /// The same for slow competitors.
    pub slow_size: usize,
    /// How often each cast all rays.
    pub rounds: usize,
    /// Which share of our hits others may answer differently.
    pub tolerance: f64,
    /// Secondary and training rays come from it.
    pub seed: u64,
}

/// A column of a scene, as it is appended to a log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// The kind of rays.
    pub column: Column,
    /// What was measured; empty where no primary ray hit anything, so that there are no such rays.
    pub rows: Vec<BenchRow>,
    /// What could not be measured, as far as it has come up in this scene since the record before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<BenchFailure>,
    /// Competitors that weren't there, likewise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<Skipped>,
}

/// One structure on the rays of one column of one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchRow {
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// Triangles of the scene.
    pub triangles: usize,
    /// The kind of rays.
    pub column: Column,
    /// How the rays were handed over.
    pub form: Form,
    /// Our spec, or the competitor and its mode.
    pub engine: String,
    /// The base that it belongs to; nothing for ours.
    pub base: Option<String>,
    /// The competitor's version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Of ours: whether it was built for rays.
    pub profile: Profile,
    /// How many rays were cast.
    pub rays: usize,
    /// Rays that hit something.
    pub hits: u64,
    /// Sum of the hit distances; 0 for any-hit rays.
    pub t_sum: f64,
    /// By the median round.
    pub mrays_per_sec: f64,
    /// By the fastest round.
    pub mrays_per_sec_best: f64,
    /// One thread's CPU time.
    pub build_secs: f64,
    /// The structure, and its copies of triangles.
    pub bytes: u64,
    /// Rays that hit something in our first structure, and nothing here.
    pub lost: u64,
    /// Rays that hit something here, and nothing in our first structure.
    pub extra: u64,
    /// Rays that hit something in both, at different distances.
    pub differ: u64,
    /// Whether that is no more than it may be. If not, the times don't count.
    pub agrees: bool,
    /// Ours on the same rays, where these are fewer than ours cast otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub same_rays: Vec<SameRays>,
}

/// Whether a structure was built for rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// By areas alone.
    None,
    /// From training rays.
    Guided,
}

/// One of ours on the rays of a slow competitor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SameRays {
    /// Ours.
    pub spec: String,
    /// By the median round.
    pub mrays_per_sec: f64,
}

/// One of ours against a base in a column, over all scenes in which both were measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchSummary {
    /// How rays were handed to ours.
    pub form: Form,
    /// The kind of rays.
    pub column: Column,
    /// Ours.
    pub spec: String,
    /// Whether it was built for rays.
    pub profile: Profile,
    /// The competitor.
    pub base: String,
    /// Always `best`: in each scene the fastest of its modes.
    pub base_mode: String,
    /// In how many scenes.
    pub n: usize,
    /// Our Mrays/s over the base's, geometric mean; above 1 is better.
    pub speedup: f64,
    /// A 95 % interval of it, bootstrapped over scenes.
    pub ci95: [f64; 2],
    /// The lowest.
    pub worst: f64,
    /// Where that was.
    pub worst_scene: String,
}

/// What builds cost, over all scenes in which it was built.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BuildSummary {
    /// Our spec, or the competitor and its mode.
    pub engine: String,
    /// In how many scenes.
    pub n: usize,
    /// Their triangles.
    pub triangles: usize,
    /// One thread's CPU time for all of them.
    pub build_secs: f64,
    /// The same for a million triangles.
    pub secs_per_million: f64,
    /// Bytes of the structures and their copies of triangles, for a triangle.
    pub bytes_per_triangle: f64,
}

/// A competitor that isn't there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Skipped {
    /// The competitor; if it is one of its modes only, the reason says so.
    pub engine: String,
    /// Why.
    pub reason: String,
}

/// What could not be measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BenchFailure {
    /// The scene's id.
    pub scene: String,
    /// Which structure; nothing if it is the scene.
    pub engine: Option<String>,
    /// Why.
    pub reason: String,
}

impl BenchDocument {
    /// What is known before anything is measured.
    pub(crate) fn new(plan: &BenchPlan, done: &[Record]) -> Self {
        let mut document = Self {
            version: 1,
            settings: Settings::of(plan),
            rows: done.iter().flat_map(|record| record.rows.clone()).collect(),
            summary: Vec::new(),
            builds: Vec::new(),
            skipped: Vec::new(),
            failures: Vec::new(),
        };
        for record in done {
            record.failures.iter().for_each(|failure| document.fail(failure));
            record.skipped.iter().for_each(|skipped| document.skip(skipped));
        }
        document
    }

    /// Notes what could not be measured, once.
    pub(crate) fn fail(&mut self, failure: &BenchFailure) {
        if !self.failures.contains(failure) {
            self.failures.push(failure.clone());
        }
    }

    /// Notes that a competitor is not there, once.
    pub(crate) fn skip(&mut self, skipped: &Skipped) {
        if !self.skipped.contains(skipped) {
            self.skipped.push(skipped.clone());
        }
    }

    /// Rows whose answers differ by more than they may.
    pub fn disagreements(&self) -> impl Iterator<Item = &BenchRow> {
        self.rows.iter().filter(|row| !row.agrees)
    }
}

impl Settings {
    /// Those of a plan.
    pub fn of(plan: &BenchPlan) -> Self {
        Self {
            specs: plan.specs.clone(),
            levels: plan.levels.iter().map(|level| level.name().to_owned()).collect(),
            twin: plan.twin,
            engines: plan.engines.iter().map(|engine| engine.name.clone()).collect(),
            columns: plan.columns.clone(),
            size: plan.size,
            slow_size: plan.slow_size,
            rounds: plan.rounds,
            tolerance: plan.tolerance,
            seed: plan.seed,
        }
    }
}

impl BenchRow {
    /// Whether the other one cast the same rays, or fewer of the same kind.
    pub(crate) fn same_case(&self, other: &Self) -> bool {
        (&self.scene, &self.view, self.column) == (&other.scene, &other.view, other.column)
    }

    /// Whether it is one of ours.
    pub fn is_ours(&self) -> bool {
        self.base.is_none()
    }
}
