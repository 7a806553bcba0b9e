//! `rdh record`: the rays of a mode as a profile.

use anyhow::Result;
use rayon::prelude::*;
use rdh::{Accel, Profile, Recorder, Spec, Training};
use rdh_study::{Mode, Plan, RayBatch};
use serde::Serialize;
use serde_json::json;

use crate::args::{RecordArgs, Size};
use crate::context::Context;
use crate::output::{print, print_json, write_file};
use crate::pick::Shelf;
use crate::staged::Staged;

/// Casts the rays through a plain tree, records them, and writes the profile.
pub(crate) fn run(args: &RecordArgs, context: &Context) -> Result<()> {
    let target = Shelf::open(context.folder.as_deref())?.find_view(&args.scene, None)?;
    let bar = context.bar(3);
    bar.set_message("reading");
    let staged = Staged::load(&target)?;
    bar.inc(1);
    bar.set_message("building");
    let accel = staged.build(&Spec::default(), &Training::none())?;
    bar.inc(1);
    bar.set_message("casting");
    let profile = record(&staged, args.mode, args.size, args.capacity, context.seed, &accel);
    let profile = profile.with_settings(&settings(args, context.seed, &staged).to_string())?;
    bar.finish_and_clear();
    write_file(&args.output, &profile.to_bytes())?;
    report(args, &profile, &staged, context)
}

/// Records each batch of a mode's rays from all threads; the sample does not depend on their order.
pub(crate) fn record(staged: &Staged, mode: Mode, size: Size, capacity: usize, seed: u64, accel: &Accel) -> Profile {
    let plan = Plan { size: [size.width, size.height], seed: film_seed(seed), ..Plan::default() };
    let recorder = Recorder::new(capacity, seed);
    for batch in staged.shoot(mode, &plan).batches(accel) {
        let RayBatch { class, query, rays } = batch;
        // An occluded ray ends at its nearest hit, so that takes a closest query too.
        rays.par_iter().for_each(|ray| recorder.record(ray, accel.closest(ray), query, class));
    }
    recorder.into_profile()
}

/// Not the seed of `compare`'s test rays: with the same --seed no ray may be both learnt and counted.
fn film_seed(seed: u64) -> u64 {
    !seed
}

fn settings(args: &RecordArgs, seed: u64, staged: &Staged) -> serde_json::Value {
    json!({
        "program": concat!("rdh ", env!("CARGO_PKG_VERSION")),
        "scene": staged.scene,
        "view": staged.view.name,
        "frame": staged.frame,
        "mode": args.mode,
        "size": [args.size.width, args.size.height],
        "seed": seed,
    })
}

#[derive(Serialize)]
struct Recorded {
    version: u32,
    file: String,
    scene: String,
    view: String,
    mode: String,
    samples: usize,
    seen: u64,
    seed: u64,
}

fn report(args: &RecordArgs, profile: &Profile, staged: &Staged, context: &Context) -> Result<()> {
    let file = args.output.display().to_string();
    if context.json {
        return print_json(&Recorded {
            version: 1,
            file,
            scene: staged.scene.clone(),
            view: staged.view.name.clone(),
            mode: args.mode.to_string(),
            samples: profile.len(),
            seen: profile.seen(),
            seed: profile.seed(),
        });
    }
    let (samples, seen, name, mode) = (profile.len(), profile.seen(), staged.name(), args.mode);
    print(&format!("{file}: {samples} of {seen} {mode} rays of {name}\n"))
}
