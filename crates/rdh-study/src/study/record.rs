//! What a study finds out, job by job: the lines of its log.

use std::fmt;

use rdh::Spec;
use serde::{Deserialize, Serialize};

use crate::integrate::Mode;
use crate::rows::{Curve, Failure, Mismatch, Row};

/// One unit of work that is done as a whole, or not at all: a view of a scene in a mode, under one experiment.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Job {
    /// The experiment's name.
    pub experiment: String,
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// The frame.
    pub frame: u32,
    /// Which integrator makes the rays.
    pub mode: Mode,
}

/// What one job found out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Which job.
    pub job: Job,
    /// The machine that measured, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub machine: Option<String>,
    /// Measurements, one per setting, class and spec; the first spec of a setting is its base.
    pub rows: Vec<Row>,
    /// What is no row: figures by depth of the tree, bounds, predictions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Curve>,
    /// What could not be run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<Failure>,
    /// Where two structures gave different answers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mismatches: Vec<Mismatch>,
}

impl Record {
    /// An empty record of a job.
    pub fn of(job: Job) -> Self {
        Self { job, machine: None, rows: Vec::new(), curves: Vec::new(), failures: Vec::new(), mismatches: Vec::new() }
    }

    /// A curve of this job.
    pub fn curve(&self, name: impl Into<String>, spec: Spec, across: &str, points: Vec<[f64; 3]>) -> Curve {
        let Job { experiment, scene, view, mode, .. } = self.job.clone();
        Curve { experiment, scene, view, mode, name: name.into(), spec, across: across.to_owned(), points }
    }

    /// The record without what a clock said, and where: equal for equal jobs.
    pub fn without_times(&self) -> Self {
        Self { machine: None, rows: self.rows.iter().map(Row::without_times).collect(), ..self.clone() }
    }
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}:{}", self.experiment, self.scene, self.view)?;
        if self.frame > 0 {
            write!(f, "@{}", self.frame)?;
        }
        write!(f, " {}", self.mode)
    }
}
