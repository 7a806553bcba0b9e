//! `rdh study`: all questions over all scenes, job by job, into a folder.

use anyhow::{Error, Result};
use indicatif::ProgressBar;
use rdh_scene::Entry;
use rdh_study::study::{Course, Progress, Scope, Shard, StudyPlan, merge, run as run_study};
use rdh_study::{Mode, Plan};

use super::merge::{print_document, sorted, verdict};
use crate::args::StudyArgs;
use crate::context::Context;
use crate::exit::usage;
use crate::machine;
use crate::output::print;
use crate::pick::Shelf;

/// Runs what is left of the study, and prints its summary if that is all of it.
pub(crate) fn run(args: &StudyArgs, context: &Context) -> Result<()> {
    let entries = entries(args, context)?;
    let scope = Scope { entries, modes: modes(args), quick: args.quick };
    let plan = StudyPlan::new(&scope, &args.experiment, &settings(args, context)).map_err(plain)?;
    let course = Course {
        folder: &args.out,
        shard: args.shard,
        resume: args.resume,
        machine: Some(machine::name()),
        threads: context.threads,
        entries: &scope.entries,
        load: &Entry::load,
    };
    let bar = context.bar(plan.jobs.len() as u64);
    run_study(&plan, &course, &mut |progress| see(progress, &bar)).map_err(plain)?;
    bar.finish_and_clear();
    if args.shard != Shard::WHOLE {
        let (shard, folder) = (args.shard, args.out.display());
        return print(&format!("part {shard} is done; join the parts with: rdh merge {folder} …\n"));
    }
    let document = merge(std::slice::from_ref(&args.out)).map_err(sorted)?.document();
    print_document(&document, context)?;
    verdict(&document, &[])
}

fn entries(args: &StudyArgs, context: &Context) -> Result<Vec<Entry>> {
    let shelf = Shelf::open(context.folder.as_deref())?;
    if args.names.is_empty() {
        return Ok(shelf.embedded().iter().chain(shelf.indexed()).cloned().collect());
    }
    let named = |name: &String| match shelf.find(name)? {
        target if target.views.is_empty() => Ok(target.entry),
        _ => Err(usage(format!("'{name}': a study takes scenes, and chooses the views"))),
    };
    args.names.iter().map(named).collect()
}

fn modes(args: &StudyArgs) -> Vec<Mode> {
    if args.mode.is_empty() { Mode::ALL.to_vec() } else { args.mode.clone() }
}

fn settings(args: &StudyArgs, context: &Context) -> Plan {
    let usual = StudyPlan::usual(args.quick);
    Plan {
        size: args.size.map_or(usual.size, |s| [s.width, s.height]),
        training: args.training.unwrap_or(usual.training),
        rounds: args.rounds.unwrap_or(usual.rounds),
        small_rounds: args.rounds.unwrap_or(usual.small_rounds),
        seed: context.seed,
        ..usual
    }
}

fn see(progress: &Progress<'_>, bar: &ProgressBar) {
    match progress {
        Progress::Resumed { done, torn } => {
            if *torn > 0 {
                tracing::warn!("the log ended in a torn line; its job is done again");
            }
            bar.set_position(*done as u64);
            bar.reset_eta();
        }
        Progress::Started { job, done, total } => {
            bar.set_length(*total as u64);
            bar.set_position(*done as u64);
            bar.set_message(job.to_string());
        }
        Progress::Finished(record) => {
            bar.inc(1);
            tracing::info!("{}: {} rows", record.job, record.rows.len());
            for failure in &record.failures {
                let spec = failure.spec.map_or_else(String::new, |s| format!(" {s}"));
                tracing::error!("{}{spec}: {}", record.job, failure.reason);
            }
            for mismatch in &record.mismatches {
                let (spec, base) = (mismatch.spec, mismatch.base);
                tracing::error!("{}: {spec} and {base} answer {} rays differently", record.job, mismatch.rays);
            }
        }
        _ => {}
    }
}

/// What was asked for makes no sense: exit code 2. All else is a failure.
fn plain(error: rdh_study::Error) -> Error {
    match error {
        rdh_study::Error::Plan(reason) => usage(reason),
        other => Error::new(other),
    }
}
