//! `rdh bench --builds`: what builds cost.

use anyhow::{Error, Result, bail};
use rdh::Spec;
use rdh_study::Target;
use rdh_study::builds::{BuildsDocument, BuildsPlan, BuildsRow, builds};
use tracing::info;

use crate::args::BenchArgs;
use crate::context::{Context, Styles};
use crate::exit::{Disagreement, usage};
use crate::output::{print, print_json};
use crate::pick::Shelf;
use crate::table::Table;

/// Builds and prints, as tables or as JSON.
pub(super) fn run(args: &BenchArgs, context: &Context) -> Result<()> {
    let specs = Spec::list(args.specs.as_deref().unwrap_or(BuildsPlan::SPECS)).map_err(|e| usage(e.to_string()))?;
    if let Some(spec) = specs.iter().find(|spec| spec.needs_rays()) {
        return Err(usage(format!("{spec} needs rays: --builds measures builds without them")));
    }
    let plan = BuildsPlan { targets: targets(args, context)?, specs, rounds: args.rounds.unwrap_or(3) };
    let document = builds(&plan, &mut |row| {
        info!("{}, {}: {:.2} CPU s per million triangles", row.scene, row.spec, row.cpu_secs_per_million());
    })?;
    if context.json {
        print_json(&document)?;
    } else {
        print(&text(&document, &context.styles))?;
    }
    verdict(&document)
}

/// Nothing is worse than trees that depend on threads; then comes what could not be built.
fn verdict(document: &BuildsDocument) -> Result<()> {
    if let Some(row) = document.rows.iter().find(|row| !row.same_trees) {
        let text = format!("{}, {}: one thread and two have built different trees", row.scene, row.spec);
        return Err(Error::new(Disagreement(text)));
    }
    match document.failures.first() {
        Some(failure) => bail!("{}: {}, {} failures in all", failure.scene, failure.reason, document.failures.len()),
        None => Ok(()),
    }
}

/// The scenes that are named; else those of the folder, and the generated ones.
fn targets(args: &BenchArgs, context: &Context) -> Result<Vec<Target>> {
    let shelf = Shelf::open(context.folder.as_deref())?;
    if !args.names.is_empty() {
        return args.names.iter().map(|name| shelf.find(name)).collect();
    }
    let of_files = shelf.indexed().iter().cloned().map(Target::all).map(Ok);
    of_files.chain(BuildsPlan::GENERATED.iter().map(|name| shelf.find(name))).collect()
}

fn text(document: &BuildsDocument, styles: &Styles) -> String {
    let mut rows = Table::new(&[
        "scene",
        ">triangles",
        "spec",
        ">CPU s per million",
        ">one thread s",
        ">two threads s",
        ">speed-up",
        ">references",
        ">bytes",
    ]);
    let mut last = "";
    for row in &document.rows {
        let first = std::mem::replace(&mut last, &row.scene) != row.scene;
        let (scene, triangles) =
            if first { (row.scene.clone(), row.triangles.to_string()) } else { Default::default() };
        rows.push(vec![
            scene.into(),
            triangles.into(),
            row.spec.clone().into(),
            format!("{:.2}", row.cpu_secs_per_million()).into(),
            format!("{:.3}", row.one_thread_secs).into(),
            format!("{:.3}", row.two_threads_secs).into(),
            format!("{:.2}", row.speedup()).into(),
            format!("{:.2}", row.references).into(),
            format!("{:.0}", bytes_per_triangle(row)).into(),
        ]);
    }
    let mut summary =
        Table::new(&["geometric means", ">scenes", ">CPU s per million", ">speed-up", ">growth exponent"]);
    for of_spec in &document.summary {
        let exponents = document.growth.iter().filter(|growth| growth.spec == of_spec.spec);
        let exponents: Vec<_> =
            exponents.map(|growth| format!("{:.2} {}", growth.exponent, growth.generator)).collect();
        summary.push(vec![
            of_spec.spec.clone().into(),
            of_spec.n.to_string().into(),
            format!("{:.2}", of_spec.cpu_secs_per_million).into(),
            format!("{:.2}", of_spec.speedup).into(),
            exponents.join(", ").into(),
        ]);
    }
    let ceiling = format!(
        "Two threads did {:.2} times the arithmetic of one meanwhile: the most that this machine allowed.\n",
        document.ceiling
    );
    [rows.text(styles.head), summary.text(styles.head), ceiling].join("\n")
}

fn bytes_per_triangle(row: &BuildsRow) -> f64 {
    row.bytes as f64 / row.triangles.max(1) as f64
}
