//! `rdh bench`: our structures and other libraries', side by side in one run.

mod builds;
mod tables;
mod watch;

use std::path::{Path, PathBuf};

use anyhow::{Error, Result, bail};
use rdh::bvh::{Triangles, Width};
use rdh::{Spec, StructureSpec};
use rdh_study::Target;
use rdh_study::bench::{BenchDocument, BenchEvent, BenchPlan, Log, Registration, Settings, bench, known_engines};

use self::watch::Watch;
use crate::args::BenchArgs;
use crate::context::Context;
use crate::exit::{Disagreement, usage};
use crate::output::{print, print_json};
use crate::pick::Shelf;

/// Runs the race and prints it, as a table or as JSON.
pub(crate) fn run(args: &BenchArgs, context: &Context) -> Result<()> {
    if args.builds {
        return builds::run(args, context);
    }
    let plan = plan(args, context)?;
    plan.check().map_err(|e| usage(e.to_string()))?;
    let (mut log, known) = match &args.out {
        Some(path) => Log::open(path, &Settings::of(&plan)).map(|(log, known)| (Some(log), known))?,
        None => (None, Vec::new()),
    };
    let mut watch = Watch::new(&plan, context);
    let mut unwritten = None;
    let document = bench(&plan, &known, &mut |event| {
        watch.see(event);
        if let (BenchEvent::Done(record), Some(log)) = (event, &mut log) {
            unwritten = unwritten.take().or(log.append(record).err());
        }
    })?;
    watch.finish();
    if context.json {
        print_json(&document)?;
    } else {
        print(&tables::text(&document, &context.styles))?;
    }
    match unwritten {
        Some(error) => Err(error.into()),
        None => verdict(&document),
    }
}

/// What is meant by the arguments.
fn plan(args: &BenchArgs, context: &Context) -> Result<BenchPlan> {
    let usual = if args.quick { BenchPlan::quick() } else { BenchPlan::default() };
    let specs = args.specs.as_deref().map(Spec::list).transpose().map_err(|e| usage(e.to_string()))?;
    let memory_bytes = args.memory.map(|gib| (gib * f64::from(1 << 30)) as u64);
    let size = args.size.unwrap_or(usual.size);
    let specs = specs.unwrap_or(usual.specs);
    Ok(BenchPlan {
        targets: targets(args, context)?,
        twin: if args.twin { Some(twin(&specs)?) } else { None },
        specs,
        levels: args.levels.clone(),
        columns: args.columns.clone().unwrap_or(usual.columns),
        engines: engines(args.engines.as_deref())?,
        programs: programs(args.engine_dir.as_deref())?,
        size,
        slow_size: usual.slow_size.min(size),
        rounds: args.rounds.unwrap_or(usual.rounds),
        tolerance: args.tolerance / 100.0,
        memory_bytes,
        seed: context.seed,
        ..usual
    })
}

/// The first structure that has a leaky twin.
fn twin(specs: &[Spec]) -> Result<Spec> {
    let has_one = |spec: &&Spec| matches!(spec.structure, StructureSpec::Bvh(bvh) if bvh.width == Width::Eight && bvh.triangles == Triangles::Copied);
    let twin = specs.iter().find(has_one).copied();
    twin.ok_or_else(|| usage("--twin: none of the specs is a bvh8 or sbvh8 with copies of triangles".to_owned()))
}

/// The scenes that are named; else all of the folder, and the generated ones.
fn targets(args: &BenchArgs, context: &Context) -> Result<Vec<Target>> {
    let shelf = Shelf::open(context.folder.as_deref())?;
    if !args.names.is_empty() {
        return args.names.iter().map(|name| shelf.find(name)).collect();
    }
    let generated = if args.quick { BenchPlan::GENERATED_QUICK } else { BenchPlan::GENERATED };
    let few = |entry: &&rdh_scene::Entry| !args.quick || entry.triangles <= BenchPlan::QUICK_TRIANGLES;
    let of_files = shelf.indexed().iter().filter(few).cloned().map(Target::all).map(Ok);
    of_files.chain(generated.iter().map(|name| shelf.find(name))).collect()
}

/// The competitors that are named; else all.
fn engines(names: Option<&[String]>) -> Result<Vec<Registration>> {
    let known = known_engines();
    let Some(names) = names else { return Ok(known) };
    if matches!(names, [one] if one == "none") {
        return Ok(Vec::new());
    }
    let find = |name: &String| {
        let list = || known.iter().map(|e| e.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = known.iter().find(|e| e.name == *name).cloned();
        found.ok_or_else(|| usage(format!("unknown competitor '{name}'; known: {}, none", list())))
    };
    names.iter().map(find).collect()
}

/// The folder that is named must be there; the usual one need not.
fn programs(named: Option<&Path>) -> Result<Option<PathBuf>> {
    match named {
        Some(folder) if folder.is_dir() => Ok(Some(folder.to_path_buf())),
        Some(folder) => bail!("{}: there is no such folder of engines", folder.display()),
        None => {
            let program = std::env::current_exe()?;
            let places = program.ancestors().skip(2).map(|folder| folder.join("engines/bin"));
            Ok(places.take(2).find(|place| place.is_dir()))
        }
    }
}

/// Nothing is worse than wrong answers; then comes what could not be run.
fn verdict(document: &BenchDocument) -> Result<()> {
    let wrong = document.disagreements().count();
    if wrong > 0 {
        let text = format!("{wrong} rows differ in their answers by more than they may: their times don't count");
        return Err(Error::new(Disagreement(text)));
    }
    match document.failures.len() {
        0 => Ok(()),
        failures => bail!("{failures} of the cases could not be run"),
    }
}
