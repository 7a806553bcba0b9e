//! Runs a study's jobs one by one, each safe in the log before the next begins.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use rdh_scene::Entry;

use super::experiment;
use super::lab::Lab;
use super::log::Log;
use super::plan::StudyPlan;
use super::record::{Job, Record};
use super::shard::Shard;
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::rows::Failure;
use crate::run::{Load, pool};

/// What a study tells while it runs.
#[derive(Debug)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// What was there already.
    Resumed {
        /// Jobs that are done.
        done: usize,
        /// Bytes of a torn line, which were cut off.
        torn: u64,
    },
    /// A job begins.
    Started {
        /// Which.
        job: &'a Job,
        /// Jobs that are behind, and all jobs of this part.
        done: usize,
        /// All jobs of this part.
        total: usize,
    },
    /// A job is done and its record safe.
    Finished(&'a Record),
}

/// Where and how a study runs.
pub struct Course<'a> {
    /// Its folder.
    pub folder: &'a Path,
    /// Which part of it.
    pub shard: Shard,
    /// Whether to go on with what is in the folder.
    pub resume: bool,
    /// The machine, in words, as records name it.
    pub machine: Option<String>,
    /// Threads that make and count rays; what is timed runs on one.
    pub threads: Option<usize>,
    /// The scenes of the plan.
    pub entries: &'a [Entry],
    /// Where scenes come from.
    pub load: &'a Load,
}

/// Runs what is left of a study's part. It may be killed at any moment: at most the running job is lost.
///
/// # Errors
/// A folder that holds another study, or one that isn't to be resumed; files that can't be read or written.
pub fn run(plan: &StudyPlan, course: &Course<'_>, observer: &mut dyn FnMut(&Progress<'_>)) -> Result<()> {
    let path = course.folder.join(course.shard.log_name());
    settle(plan, course, &path)?;
    let (mut log, contents) = Log::<Record>::open(&path)?;
    let (mut done, torn) = (contents.records.len(), contents.torn);
    observer(&Progress::Resumed { done, torn });
    let behind: BTreeSet<Job> = contents.records.into_iter().map(|r| r.job).collect();
    let jobs = course.shard.jobs(plan);
    let (settings, pool, total) = (plan.settings(course.threads), pool(course.threads)?, jobs.len());
    let left: Vec<Job> = jobs.into_iter().filter(|job| !behind.contains(job)).collect();
    for of_scene in left.chunk_by(|a, b| (&a.scene, a.frame) == (&b.scene, b.frame)) {
        let lab = open(&of_scene[0], course, &settings, pool.as_ref());
        for job in of_scene {
            observer(&Progress::Started { job, done, total });
            let record = Record { machine: course.machine.clone(), ..run_job(job, lab.as_ref()) };
            log.append(&record)?;
            done += 1;
            observer(&Progress::Finished(&record));
        }
    }
    Ok(())
}

/// Makes the folder this study's, or checks that it is.
fn settle(plan: &StudyPlan, course: &Course<'_>, log: &Path) -> Result<()> {
    let Some(there) = StudyPlan::read(course.folder)? else {
        return plan.write(course.folder);
    };
    if let Some(difference) = there.difference(plan) {
        let folder = course.folder.display();
        return Err(Error::Plan(format!("{folder} holds another study; the first difference is {difference}")));
    }
    if !course.resume && log.exists() {
        let folder = course.folder.display();
        return Err(Error::Plan(format!("{folder} holds this study already; --resume goes on with it")));
    }
    Ok(())
}

fn open<'a>(
    job: &Job,
    course: &Course<'a>,
    settings: &'a Plan,
    pool: Option<&'a rayon::ThreadPool>,
) -> Result<Lab<'a>, String> {
    let entry = course.entries.iter().find(|e| e.id == job.scene);
    let entry = entry.ok_or_else(|| format!("scene '{}' isn't there", job.scene))?;
    Lab::open(entry, job.frame, settings, course.load, pool)
}

/// What goes wrong stands in the record: the other jobs go on.
fn run_job(job: &Job, lab: Result<&Lab<'_>, &String>) -> Record {
    let mut found = Record::of(job.clone());
    let experiment = experiment::find(&job.experiment).ok_or_else(|| "there is no such experiment".to_owned());
    let work = || lab.map_err(Clone::clone).and_then(|lab| experiment.and_then(|e| e.run(lab, &mut found)));
    // A bug that one job meets must not keep the others from being done, now or when the study is resumed. What the job has found until
    // then is plain data.
    let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err("it panicked".to_owned()));
    if let Err(reason) = result {
        let (scene, view) = (job.scene.clone(), Some(job.view.clone()));
        found.failures.push(Failure { scene, view, spec: None, reason });
    }
    found
}
