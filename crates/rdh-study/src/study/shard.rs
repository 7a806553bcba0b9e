//! Parts of a study that different machines do.

use std::fmt;
use std::str::FromStr;

use super::plan::StudyPlan;
use super::record::Job;

/// One of several parts, `I/N` with I from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    part: usize,
    of: usize,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// The log's name: `jobs.log`, or `jobs-2-of-3.log`.
    pub fn log_name(self) -> String {
        if self == Self::WHOLE { "jobs.log".to_owned() } else { format!("jobs-{}-of-{}.log", self.part, self.of) }
    }

    /// This part's jobs, in the plan's order. A scene's jobs stay together, so that it is loaded on one machine only; the heaviest scenes
    /// are given out first, each to the part that has least.
    pub fn jobs(self, plan: &StudyPlan) -> Vec<Job> {
        let mut scenes: Vec<(f64, &str)> = Vec::new();
        for (id, triangles) in &plan.scenes {
            let jobs = plan.jobs.iter().filter(|j| j.scene == *id).count();
            // Rays cost the same in every scene, to a first approximation; builds cost by the triangle.
            scenes.push((jobs as f64 * (100_000.0 + *triangles as f64), id));
        }
        scenes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut loads = vec![0.0f64; self.of];
        let mut mine = Vec::new();
        for (weight, id) in scenes {
            let least = (0..self.of).min_by(|&a, &b| loads[a].total_cmp(&loads[b])).unwrap_or(0);
            loads[least] += weight;
            if least + 1 == self.part {
                mine.push(id);
            }
        }
        plan.jobs.iter().filter(|j| mine.contains(&j.scene.as_str())).cloned().collect()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((part, of)) if (1..=of).contains(&part) && of <= 10_000 => Ok(Self { part, of }),
            _ => Err("I/N is needed, with I from 1 to N: 2/3 is the second of three parts".to_owned()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}
