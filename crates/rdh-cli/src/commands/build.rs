//! `rdh build`: a structure for a scene, and for rays, as a file.

use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use rdh::{Accel, BuildOptions, Profile, Provenance, Spec, Training, build};
use rdh_scene::saved;
use serde::Serialize;
use serde_json::{Value, json};

use super::rays;
use crate::args::BuildArgs;
use crate::context::Context;
use crate::exit::usage;
use crate::output::{print, print_json};
use crate::pick::Shelf;
use crate::staged::Staged;

/// Builds, saves, and says what became of it.
pub(crate) fn run(args: &BuildArgs, context: &Context) -> Result<()> {
    let rays = args.rays.as_deref().map(|file| Rays::read(file, context.seed)).transpose()?;
    let spec = spec(args)?;
    let target = Shelf::open(context.folder.as_deref())?.find(&args.scene)?;
    let bar = context.bar(3);
    bar.set_message("reading");
    let staged = Staged::load(&target)?;
    if let Some((file, rays)) = args.rays.as_deref().zip(rays.as_ref()) {
        rays::warn_of_other_scene(file, &rays.note["settings"], &staged.scene);
    }
    bar.inc(1);
    bar.set_message("building");
    let none = Training::none();
    let training = rays.as_ref().map_or(&none, |rays| &rays.training);
    let start = Instant::now();
    let accel = build(staged.stage.mesh(), &spec, training, &BuildOptions::default())
        .with_context(|| format!("{} can't be built by {spec}", staged.scene))?;
    let build_secs = start.elapsed().as_secs_f64();
    bar.inc(1);
    bar.set_message("writing");
    let provenance = provenance(&accel, &staged, rays, context.seed);
    let accel = accel.with_provenance(provenance);
    saved::save(&accel, &args.output)?;
    bar.finish_and_clear();
    report(&args.output, &accel, &staged, build_secs, context)
}

/// What is built: what was asked for, else what suits.
fn spec(args: &BuildArgs) -> Result<Spec> {
    let usual = if args.rays.is_some() { "bvh8+rdh" } else { "bvh8+sah" };
    let spec = args.spec.map_or_else(|| usual.parse(), Ok)?;
    if spec.needs_rays() && args.rays.is_none() {
        return Err(usage(format!("{spec} needs --rays F.rays, such as `rdh record` writes")));
    }
    Ok(spec)
}

/// The rays of a file, by what they are used for.
struct Rays {
    training: Training,
    /// None of the training rays; nothing if the file holds training rays alone.
    unseen: Option<Profile>,
    /// What is noted of them.
    note: Value,
}

impl Rays {
    fn read(file: &Path, seed: u64) -> Result<Self> {
        let profile = rays::read(file)?;
        let settings: Value = serde_json::from_str(profile.settings())?;
        let note = json!({ "samples": profile.len(), "seen": profile.seen(), "settings": settings });
        match settings["set"]["name"].as_str() {
            None => {
                let [training, _, unseen] = profile.split_profiles(seed);
                Ok(Self { training: Training::from_samples(training.samples().to_vec()), unseen: Some(unseen), note })
            }
            Some("training") => {
                Ok(Self { training: Training::from_samples(profile.samples().to_vec()), unseen: None, note })
            }
            Some(other) => Err(usage(format!("{}: the {other} set is not for building", file.display()))),
        }
    }
}

/// The evidence is there already, if `auto` has chosen.
fn provenance(accel: &Accel, staged: &Staged, rays: Option<Rays>, seed: u64) -> Provenance {
    let (unseen, note) = rays.map_or((None, Value::Null), |rays| (rays.unseen, rays.note));
    let settings = json!({ "scene": *staged.setting, "rays": note });
    Provenance { seed: Some(seed), settings, unseen, ..accel.provenance().clone() }
}

#[derive(Serialize)]
struct Built {
    version: u32,
    file: String,
    scene: String,
    #[serde(flatten)]
    stats: rdh::Stats,
    unseen_rays: usize,
    file_bytes: u64,
    build_secs: f64,
    fingerprint: String,
}

fn report(file: &Path, accel: &Accel, staged: &Staged, build_secs: f64, context: &Context) -> Result<()> {
    let stats = *accel.stats();
    let file_bytes = fs::metadata(file).map_or(0, |about| about.len());
    let file = file.display().to_string();
    if context.json {
        let unseen_rays = accel.provenance().unseen.as_ref().map_or(0, Profile::len);
        let fingerprint = format!("{:016x}", accel.fingerprint());
        let scene = staged.scene.clone();
        return print_json(&Built { version: 1, file, scene, stats, unseen_rays, file_bytes, build_secs, fingerprint });
    }
    print(&format!(
        "{file}: {} over {} triangles of {}, {} nodes, {:.1} MB, built in {build_secs:.2} s\n",
        stats.spec,
        stats.triangles,
        staged.scene,
        stats.nodes,
        file_bytes as f64 * 1e-6
    ))
}
