//! `cargo xtask soak`: rays without end from inside closed meshes, and what comes of it kept for the page of `cargo xtask reliability`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use crate::reliability::{Verdict, grouped, keep_found};

/// Cast rays from inside closed meshes through every structure: a miss, or two answers, is a failure.
///
/// A ray counts once for each structure and query. The same number and seed cast the same rays on any number of threads.
#[derive(Debug, clap::Parser)]
pub(crate) struct Arguments {
    /// How many rays, 1e9 for instance
    #[arg(long, default_value = "1e7")]
    rays: String,
    /// How many more in each form of batches; none with --brute
    #[arg(long, default_value = "1e7")]
    batches: String,
    /// End after about so many minutes, with fewer rays; batches are not counted
    #[arg(long)]
    minutes: Option<u64>,
    /// Other seeds make other rays
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Small meshes, of which brute force says what is right
    #[arg(long)]
    brute: bool,
    /// A folder of scenes, of which the closed ones are cast at as well [default: ../shared/scenes, if it is there]
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
    /// The folder of the competitors' programs, which get rays that are aimed alike (cargo xtask engines)
    #[arg(long, value_name = "DIR")]
    engines: Option<PathBuf>,
    /// How many of each mesh and aim they get
    #[arg(long, default_value_t = 100_000)]
    engine_rays: usize,
    /// Cargo's profile
    #[arg(long, default_value = "release")]
    profile: String,
}

/// Whether nothing was missed.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let root = crate::root();
    let found = crate::target()?.join(if arguments.brute { "brute.json" } else { "soak.json" });
    // Nothing old may stand for a run that ends early.
    std::fs::remove_file(&found).ok();
    let beside = root.join("../shared/scenes");
    let scenes = arguments.scenes.clone().or_else(|| beside.join("scenes.toml").is_file().then_some(beside));
    let mut command = Command::new("cargo");
    command.args(["run", "--quiet", "--profile", &arguments.profile, "-p", "rdh-study", "--example", "soak", "--"]);
    command.args(["--rays", &arguments.rays, "--seed", &arguments.seed.to_string()]).arg("--json").arg(&found);
    if let Some(minutes) = arguments.minutes {
        command.args(["--minutes", &minutes.to_string()]);
    }
    if arguments.brute {
        command.arg("--brute");
    } else {
        command.args(["--batches", &arguments.batches]);
        command.args(scenes.iter().flat_map(|folder| [Path::new("--scenes"), folder]));
    }
    if let Some(engines) = &arguments.engines {
        command.arg("--engines").arg(engines).args(["--engine-rays", &arguments.engine_rays.to_string()]);
    }
    let start = Instant::now();
    let fine = command.current_dir(root).status().context("cargo")?.success();
    let minutes = start.elapsed().as_secs().div_ceil(60);
    let text =
        std::fs::read_to_string(&found).with_context(|| format!("{}: nothing was found out", found.display()))?;
    keep_records(arguments, serde_json::from_str(&text)?, minutes, fine)?;
    Ok(fine)
}

/// What the page says in its tables.
fn keep_records(arguments: &Arguments, mut found: Value, minutes: u64, fine: bool) -> Result<()> {
    if arguments.engines.is_some() {
        let count = format!("{} rays of each mesh and aim", grouped(arguments.engine_rays as u64));
        let others = json!({ "aims": found["aims"], "others": found["others"].take() });
        keep_found("others", &count, &Verdict::Fine, others)?;
    }
    let check = if arguments.brute { "brute" } else { "soak" };
    let total = |key: &str| found["total"][key].as_u64().unwrap_or_default();
    let in_batches = |which: usize| batches(&found).map(|form| form[which]).sum::<u64>();
    let meshes = found["meshes"].as_array().map_or(0, Vec::len);
    let structures = found["specs"].as_array().map_or(0, Vec::len);
    let (casts, rays, batched) = (grouped(total("casts")), grouped(total("rays")), grouped(in_batches(0)));
    let count = format!(
        "{casts} casts of {rays} rays in {meshes} meshes, {structures} structures, {batched} more in batches, seed {}, {minutes} minutes",
        arguments.seed
    );
    let (missed, different) = (total("misses") + in_batches(1), total("different") + in_batches(2));
    let why = format!("{missed} missed, {different} different");
    keep_found(check, &count, &if fine { Verdict::Fine } else { Verdict::Failed(&why) }, found)
}

/// Casts, misses, and answers other than alone, of each form of batches.
fn batches(found: &Value) -> impl Iterator<Item = [u64; 3]> {
    let forms = found["batches"]["by_form"].as_array().into_iter().flatten();
    forms.map(|form| [0, 1, 2].map(|i| form[i].as_u64().unwrap_or_default()))
}
