//! Joins the parts of a study, and checks that nothing is missing.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::log;
use super::plan::StudyPlan;
use super::record::{Job, Record};
use crate::error::{Error, Result};
use crate::rows::{Document, Row};
use crate::summary::summarise_settings;

/// A study as far as it has come.
#[derive(Debug, Clone, PartialEq)]
pub struct Merged {
    /// Its plan.
    pub plan: StudyPlan,
    /// The records, in the plan's order.
    pub records: Vec<Record>,
    /// Jobs without a record.
    pub missing: Vec<Job>,
}

/// Reads the logs of one or more folders that hold parts of the same study.
///
/// A job that was done twice is taken from where it stands first.
///
/// # Errors
/// Folders without a plan or with different ones, damaged logs, and runs of one job whose counts differ.
pub fn merge(folders: &[PathBuf]) -> Result<Merged> {
    let plan = common_plan(folders)?;
    let mut found: BTreeMap<Job, Record> = BTreeMap::new();
    for folder in folders {
        for path in logs(folder)? {
            for record in log::read(&path)?.records {
                take(&mut found, record, &path)?;
            }
        }
    }
    let (mut records, mut missing) = (Vec::new(), Vec::new());
    for job in &plan.jobs {
        match found.remove(job) {
            Some(record) => records.push(record),
            None => missing.push(job.clone()),
        }
    }
    match found.keys().next() {
        Some(job) => Err(Error::Plan(format!("a log holds a job that the plan doesn't: {job}"))),
        None => Ok(Merged { plan, records, missing }),
    }
}

impl Merged {
    /// Rows, summaries by setting, and what went wrong: the document that `compare` prints.
    pub fn document(&self) -> Document {
        Document {
            version: Document::VERSION,
            // Of structures that disagree no time counts.
            summary: summarise_settings(&self.rows(|record| record.mismatches.is_empty())),
            rows: self.rows(|_| true),
            failures: self.records.iter().flat_map(|r| r.failures.clone()).collect(),
            mismatches: self.records.iter().flat_map(|r| r.mismatches.clone()).collect(),
            curves: self.records.iter().flat_map(|r| r.curves.clone()).collect(),
        }
    }

    /// The rows of some records: experiment by experiment, whichever scene each of them began with.
    fn rows(&self, wanted: impl Fn(&Record) -> bool) -> Vec<Row> {
        let mut rows = Vec::new();
        for name in &self.plan.experiments {
            let of_experiment = self.records.iter().filter(|r| r.job.experiment == *name && wanted(r));
            rows.extend(of_experiment.flat_map(|r| r.rows.clone()));
        }
        rows
    }

    /// Writes the study into a folder of its own, as if one machine had done it.
    ///
    /// # Errors
    /// A folder that holds a study already; what the system says.
    pub fn write(&self, folder: &Path) -> Result<()> {
        if StudyPlan::read(folder)?.is_some() {
            return Err(Error::Plan(format!("{} holds a study already", folder.display())));
        }
        self.plan.write(folder)?;
        let (mut log, _) = log::Log::open(&folder.join(super::Shard::WHOLE.log_name()))?;
        self.records.iter().try_for_each(|record| log.append(record))
    }
}

fn common_plan(folders: &[PathBuf]) -> Result<StudyPlan> {
    let mut common: Option<(StudyPlan, &Path)> = None;
    for folder in folders {
        let none = || Error::Plan(format!("{} holds no study", folder.display()));
        let plan = StudyPlan::read(folder)?.ok_or_else(none)?;
        match &common {
            None => common = Some((plan, folder)),
            Some((first, place)) => {
                if let Some(difference) = first.difference(&plan) {
                    let (a, b) = (place.display(), folder.display());
                    let text = format!("{a} and {b} hold different studies; the first difference is {difference}");
                    return Err(Error::Plan(text));
                }
            }
        }
    }
    common.map(|(plan, _)| plan).ok_or_else(|| Error::Plan("no folders".to_owned()))
}

/// All logs in a folder, by name.
fn logs(folder: &Path) -> Result<Vec<PathBuf>> {
    let is_log = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("jobs") && name.ends_with(".log")
    };
    let entries = fs::read_dir(folder).map_err(Error::file(folder))?;
    let paths: std::io::Result<Vec<PathBuf>> = entries.map(|e| e.map(|e| e.path())).collect();
    let mut logs: Vec<PathBuf> = paths.map_err(Error::file(folder))?.into_iter().filter(is_log).collect();
    logs.sort();
    Ok(logs)
}

fn take(found: &mut BTreeMap<Job, Record>, record: Record, path: &Path) -> Result<()> {
    if let Some(first) = found.get(&record.job) {
        if first.without_times() != record.without_times() {
            let (path, job) = (path.display(), &record.job);
            return Err(Error::Disagreement(format!("{path}: {job} was done twice, with different counts")));
        }
        return Ok(());
    }
    found.insert(record.job.clone(), record);
    Ok(())
}
