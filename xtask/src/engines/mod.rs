//! `cargo xtask engines`: our structures and other libraries' on the same rays, answers compared before times.
//!
//! ```text
//!  report       tables and JSON
//!  race         one scene: interleaved rounds, verified answers
//!  contender    what casts rays: a structure of ours, or an engine's process
//!  columns      the kinds of rays
//!  install      where Embree is, and how to get it
//!  files        mesh and ray files
//! ```

mod columns;
mod contender;
mod files;
mod install;
mod race;
mod report;

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use rdh::Spec;
use rdh_scene::catalog::{self, Entry};

use columns::Column;
use contender::EmbreeSpec;
use report::Report;

/// Race our structures against other libraries'.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scenes by id or path; without any, all of --scenes, else the embedded quick set
    scene: Vec<String>,
    /// A folder with a scenes.toml
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
    /// Our structures, separated by commas; those that need rays are trained on other rays of the same columns
    #[arg(long, default_value = "kd+sah")]
    specs: String,
    /// Kinds of rays
    #[arg(long, value_delimiter = ',', default_value = "rows,shadow")]
    columns: Vec<Column>,
    /// Embree's builds: QUALITY[-robust]-ISA
    #[arg(long, value_delimiter = ',', default_value = "high-avx2,high-avx512", value_name = "BUILD")]
    embree: Vec<EmbreeSpec>,
    /// Width and height of the film in pixels
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=8192))]
    size: u32,
    /// How often each casts all rays
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// The folder that holds libembree4 [default: EMBREE_LIB, else what --fetch got]
    #[arg(long, value_name = "DIR")]
    lib: Option<PathBuf>,
    /// Get Embree from the Python package index first
    #[arg(long)]
    fetch: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Whether all answers agreed.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    if arguments.fetch {
        install::fetch()?;
    }
    let specs = Spec::list(&arguments.specs)?;
    ensure!(!specs.is_empty() && !arguments.columns.is_empty(), "there is nothing to do: no specs or no columns");
    let engine = install::engine(arguments.lib.as_deref())?;
    if let Err(why) = &engine {
        eprintln!("embree: skipped: {why}");
    }
    let plan = race::Plan {
        specs,
        columns: arguments.columns.clone(),
        embree: engine.map(|engine| (engine, arguments.embree.clone())).ok(),
        size: arguments.size as usize,
        rounds: arguments.rounds as usize,
    };
    let mut report = Report::default();
    for entry in entries(arguments)? {
        race::run(&entry, &plan, &mut report).with_context(|| entry.id.clone())?;
    }
    if arguments.json {
        report.print_json()?
    } else {
        report.print_table()
    }
    Ok(report.faults.is_empty())
}

fn entries(arguments: &Arguments) -> Result<Vec<Entry>> {
    let listed = arguments.scenes.as_deref().map(catalog::indexed).transpose()?.unwrap_or_default();
    match (arguments.scene.is_empty(), arguments.scenes.is_some()) {
        (true, true) => Ok(listed),
        (true, false) => Ok(catalog::embedded()?.into_iter().filter(|e| e.quick).collect()),
        (false, _) => arguments.scene.iter().map(|name| Ok(catalog::find(name, &listed)?)).collect(),
    }
}
