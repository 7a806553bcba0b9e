//! From records to pairs: a structure and the base of its setting, on the same rays.

use rdh::{RayClass, Spec};
use rdh_scene::Kind;

use crate::rows::Row;
use crate::stats::{median, paired_interval, ratio};
use crate::study::{Job, Record};

/// A structure and the base of its setting, on the same rays of one view.
#[derive(Debug, Clone)]
pub(super) struct Pair<'r> {
    pub job: &'r Job,
    pub kind: Kind,
    /// In words; empty if the experiment has but one.
    pub setting: &'r str,
    pub x: Option<f64>,
    /// `None` for all classes of the job together.
    pub class: Option<RayClass>,
    pub spec: Spec,
    pub base: Spec,
    pub ours: Cost,
    pub theirs: Cost,
    pub depth_complexity: Option<f64>,
}

/// What one structure did, in totals over its rays.
#[derive(Debug, Clone, Default)]
pub(super) struct Cost {
    pub rays: f64,
    pub steps: f64,
    pub tests: f64,
    pub nanos: f64,
    pub round_nanos: Vec<f64>,
    pub build_secs: f64,
    pub rrs_secs: f64,
    pub bytes: f64,
    pub references: f64,
    /// The 99.9th percentile of steps + tests; `None` for several classes together.
    pub worst: Option<f64>,
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Metric {
    Steps,
    Tests,
    Time,
    Build,
    /// Build, and the acquisition of the training rays.
    BuildAndRays,
    /// All of it: build, training rays, and casting the rays that were counted once.
    Frame,
    Bytes,
    References,
    /// The 99.9th percentile of steps + tests.
    Worst,
}

/// All pairs of some records: per class, and for all classes of a job together. Where structures disagree nothing counts.
pub(super) fn pairs(records: &[Record]) -> Vec<Pair<'_>> {
    records.iter().filter(|r| r.mismatches.is_empty()).flat_map(pairs_of).collect()
}

impl Metric {
    /// The head of its column.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Steps => "steps",
            Self::Tests => "tests",
            Self::Time => "time",
            Self::Build => "build",
            Self::BuildAndRays => "build + rays",
            Self::Frame => "whole frame",
            Self::Bytes => "memory",
            Self::References => "references",
            Self::Worst => "99.9th percentile",
        }
    }

    fn of(self, cost: &Cost) -> Option<f64> {
        Some(match self {
            Self::Steps => cost.steps,
            Self::Tests => cost.tests,
            Self::Time => cost.nanos,
            Self::Build => cost.build_secs * 1e9,
            Self::BuildAndRays => (cost.build_secs + cost.rrs_secs) * 1e9,
            Self::Frame => (cost.build_secs + cost.rrs_secs) * 1e9 + cost.nanos,
            Self::Bytes => cost.bytes,
            Self::References => cost.references,
            Self::Worst => return cost.worst,
        })
    }
}

impl Pair<'_> {
    /// Ours to theirs: below 1 is better. Nothing where it was not measured.
    pub(super) fn ratio(&self, metric: Metric) -> Option<f64> {
        let ratio = match metric {
            Metric::Time if !self.ours.round_nanos.is_empty() => median(&self.round_ratios()),
            _ => ratio(metric.of(&self.ours)?, metric.of(&self.theirs)?),
        };
        ratio.is_finite().then_some(ratio)
    }

    fn round_ratios(&self) -> Vec<f64> {
        let rounds = self.ours.round_nanos.iter().zip(&self.theirs.round_nanos);
        rounds.map(|(&a, &b)| ratio(a, b)).collect()
    }

    /// The 95 % interval of the time's ratio over the rounds.
    pub(super) fn time_interval(&self) -> Option<[f64; 2]> {
        paired_interval(&self.round_ratios())
    }

    /// `scene:view`, with the frame where it is not the scene at rest.
    pub(super) fn place(&self) -> String {
        let frame = if self.job.frame > 0 { format!("@{}", self.job.frame) } else { String::new() };
        format!("{}:{}{frame}", self.job.scene, self.job.view)
    }
}

/// One structure under one setting: its rows, one a class.
struct Column<'r> {
    setting: &'r str,
    x: Option<f64>,
    spec: Spec,
    rows: Vec<&'r Row>,
}

fn pairs_of(record: &Record) -> Vec<Pair<'_>> {
    let columns = columns(record);
    let mut pairs = Vec::new();
    for (i, ours) in columns.iter().enumerate() {
        let base = columns.iter().position(|c| c.setting == ours.setting);
        let Some(theirs) = base.filter(|&b| b != i).map(|b| &columns[b]) else { continue };
        let mut total = None;
        for row in &ours.rows {
            let Some(other) = theirs.rows.iter().find(|r| r.class == row.class) else { continue };
            let pair = pair(record, ours, theirs.spec, row, other);
            add_total(&mut total, &pair);
            pairs.push(pair);
        }
        pairs.extend(total);
    }
    pairs
}

/// The same spec twice under one setting is two columns: a run against itself.
fn columns(record: &Record) -> Vec<Column<'_>> {
    let mut columns: Vec<Column<'_>> = Vec::new();
    for row in &record.rows {
        let setting = row.setting.as_deref().unwrap_or_default();
        let takes = |c: &&mut Column<'_>| {
            c.setting == setting && c.x == row.x && c.spec == row.spec && c.rows.iter().all(|r| r.class != row.class)
        };
        match columns.iter_mut().find(takes) {
            Some(column) => column.rows.push(row),
            None => columns.push(Column { setting, x: row.x, spec: row.spec, rows: vec![row] }),
        }
    }
    columns
}

fn pair<'r>(record: &'r Record, column: &Column<'r>, base: Spec, ours: &Row, theirs: &Row) -> Pair<'r> {
    Pair {
        job: &record.job,
        kind: ours.kind,
        setting: column.setting,
        x: column.x,
        class: Some(ours.class),
        spec: column.spec,
        base,
        ours: Cost::of(ours),
        theirs: Cost::of(theirs),
        depth_complexity: ours.depth_complexity.or(theirs.depth_complexity),
    }
}

fn add_total<'r>(total: &mut Option<Pair<'r>>, pair: &Pair<'r>) {
    match total {
        None => *total = Some(Pair { class: None, ..pair.clone() }),
        Some(total) => {
            total.ours.add(&pair.ours);
            total.theirs.add(&pair.theirs);
        }
    }
}

impl Cost {
    fn of(row: &Row) -> Self {
        let rays = row.rays as f64;
        Self {
            rays,
            steps: row.steps_per_ray * rays,
            tests: row.tests_per_ray * rays,
            nanos: row.nanos_per_ray * rays,
            round_nanos: row.round_nanos_per_ray.iter().map(|n| n * rays).collect(),
            build_secs: row.build_secs,
            rrs_secs: row.rrs_secs,
            bytes: row.bytes as f64,
            references: row.references as f64,
            worst: (row.cost_p999 > 0).then_some(row.cost_p999 as f64),
        }
    }

    /// Another class of rays through the same structure.
    fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.steps += other.steps;
        self.tests += other.tests;
        // The rounds of a case ran together: their sums are rounds of the whole.
        self.round_nanos = self.round_nanos.iter().zip(&other.round_nanos).map(|(a, b)| a + b).collect();
        self.nanos = if self.round_nanos.is_empty() { self.nanos + other.nanos } else { median(&self.round_nanos) };
        self.worst = None;
    }
}
