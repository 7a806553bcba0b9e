//! `rdh merge`: the parts of a study, joined and checked.

use anyhow::{Error, Result};
use rdh_study::study::{Job, merge};
use rdh_study::{Document, Row, Verdict};

use crate::args::MergeArgs;
use crate::context::Context;
use crate::exit::Disagreement;
use crate::output::{print, print_json};
use crate::summary::study_text;

/// Joins, checks, and prints.
pub(crate) fn run(args: &MergeArgs, context: &Context) -> Result<()> {
    let merged = merge(&args.folders).map_err(sorted)?;
    if let Some(folder) = &args.output {
        merged.write(folder)?;
    }
    let mut document = merged.document();
    if args.counts_only {
        document.rows = document.rows.iter().map(Row::without_times).collect();
        document.summary = Vec::new();
    }
    print_document(&document, context)?;
    verdict(&document, &merged.missing)
}

/// The summary as tables, or everything as JSON.
pub(super) fn print_document(document: &Document, context: &Context) -> Result<()> {
    if context.json { print_json(document) } else { print(&study_text(document, &context.styles)) }
}

/// Nothing is worse than wrong answers or a hole; then comes what could not be run.
pub(super) fn verdict(document: &Document, missing: &[Job]) -> Result<()> {
    if document.verdict() == Verdict::Mismatch {
        let count = document.mismatches.len();
        return disagreement(format!("structures disagree in {count} cases: none of their times count"));
    }
    if let Some(job) = missing.first() {
        return disagreement(format!("{} jobs are missing, the first is {job}", missing.len()));
    }
    match document.failures.len() {
        0 => Ok(()),
        count => Err(anyhow::anyhow!("{count} of the cases could not be run")),
    }
}

fn disagreement(text: String) -> Result<()> {
    Err(Error::new(Disagreement(text)))
}

/// Counts that differ are exit code 3.
pub(super) fn sorted(error: rdh_study::Error) -> Error {
    match error {
        rdh_study::Error::Disagreement(text) => Error::new(Disagreement(text)),
        other => Error::new(other),
    }
}
