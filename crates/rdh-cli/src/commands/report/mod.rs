//! `rdh report`: a study as one page.

mod about;
mod pictures;

use anyhow::{Context as _, Result};
use rdh_study::report::{About, html, markdown};
use rdh_study::study::merge;
use serde_json::json;

use super::merge::sorted;
use crate::args::ReportArgs;
use crate::context::Context;
use crate::output::{print, print_json, write_file};
use crate::pick::Shelf;

/// Reads the study, draws the pictures, writes the page.
pub(crate) fn run(args: &ReportArgs, context: &Context) -> Result<()> {
    let merged = merge(&args.folders).map_err(sorted)?;
    let shelf = Shelf::open(context.folder.as_deref())?;
    let pictures = if args.no_pictures { Vec::new() } else { pictures::draw(&merged, &shelf, context) };
    let about = About { pictures, ..about::about(args, &merged, shelf.embedded()) };
    let folder = args.folders.first().context("no folder")?;
    let file = args.output.clone().unwrap_or_else(|| folder.join("report.html"));
    let page = html(&merged.records, &about);
    write_file(&file, page.as_bytes())?;
    if let Some(file) = &args.markdown {
        write_file(file, markdown(&merged.records).as_bytes())?;
    }
    let (jobs, missing) = (merged.records.len(), merged.missing.len());
    if context.json {
        return print_json(
            &json!({ "version": 1, "file": file, "bytes": page.len(), "jobs": jobs, "missing": missing }),
        );
    }
    let holes = if missing > 0 { format!("; {missing} are missing") } else { String::new() };
    print(&format!("{}: {jobs} jobs{holes}, {} KiB\n", file.display(), page.len() / 1024))
}
