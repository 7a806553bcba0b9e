//! `rdh verify`: a saved tree, proved.

mod text;

use anyhow::{Context as _, Error, Result};
use rdh::{Accel, BuildOptions, Profile, Ray, Spec, StructureSpec, Training, build};
use rdh_scene::saved;
use rdh_study::verify::{Agreement, Judge, Race, agreement, aimed_rays, race};
use serde::Serialize;

use super::build::read_profile;
use crate::args::VerifyArgs;
use crate::context::Context;
use crate::exit::{Disagreement, usage};
use crate::output::{print, print_json};

/// What was found out.
#[derive(Serialize)]
struct Verified {
    version: u32,
    file: String,
    #[serde(flatten)]
    stats: rdh::Stats,
    /// What is wrong with nodes and triangles.
    faults: Vec<String>,
    /// Nothing if the tree is not well-formed.
    brute_force: Option<Agreement>,
    /// One a base; none without unseen rays, or for a tree that was built by areas itself.
    races: Vec<Race>,
    ok: bool,
}

/// Opens, checks, compares, races, prints; anything wrong is exit code 3.
pub(crate) fn run(args: &VerifyArgs, context: &Context) -> Result<()> {
    let bar = context.bar(4);
    bar.set_message("reading");
    // In memory of our own, as the base will be: a race of memory is not meant.
    let accel = saved::open_copy(&args.tree)?;
    let bases = bases(args, &accel)?;
    let unseen = unseen(args, &accel, context.seed)?;
    bar.inc(1);
    bar.set_message("checking");
    let faults: Vec<String> = accel.check(accel.mesh()).into_iter().map(|fault| fault.0).collect();
    bar.inc(1);
    bar.set_message("comparing with brute force");
    let sound = faults.is_empty();
    let brute_force = sound.then(|| agreement(&accel, accel.mesh(), &samples(args, &accel, unseen.as_ref(), context)));
    bar.inc(1);
    bar.set_message("racing");
    let races = match &unseen {
        Some(rays) if sound && !rays.is_empty() => races(args, &accel, &bases, rays)?,
        _ => Vec::new(),
    };
    bar.finish_and_clear();
    let right = sound && brute_force.as_ref().is_some_and(|b| b.different == 0);
    let ok = right && races.iter().all(|race| race.different == 0 && !race.slower);
    let file = args.tree.display().to_string();
    let verified = Verified { version: 1, file, stats: *accel.stats(), faults, brute_force, races, ok };
    if context.json {
        print_json(&verified)?
    } else {
        print(&text::text(&verified, unseen.as_ref()))?
    }
    if ok { Ok(()) } else { Err(Error::new(Disagreement(text::verdict(&verified)))) }
}

/// What the tree must not be slower than.
fn bases(args: &VerifyArgs, accel: &Accel) -> Result<Vec<Spec>> {
    let spec = accel.stats().spec;
    let bases = match &args.base {
        Some(specs) => Spec::list(specs).map_err(|e| usage(e.to_string()))?,
        None if accel.provenance().evidence.is_some() => {
            ["bvh8(high)+sah", "sbvh8(high)+sah", "kd+sah"].iter().map(|s| s.parse()).collect::<rdh::Result<_>>()?
        }
        None => vec![by_areas(&spec)],
    };
    if let Some(base) = bases.iter().find(|base| base.needs_rays()) {
        return Err(usage(format!("{base} is not built by areas alone")));
    }
    Ok(bases.into_iter().filter(|base| *base != spec).collect())
}

/// The same structure, by areas; pruned as usual, since pruning by visits is of the rays.
fn by_areas(spec: &Spec) -> Spec {
    let mut base = Spec { heuristic: rdh::HeuristicSpec::Sah, ..*spec };
    if let StructureSpec::Kd(kd) = &mut base.structure {
        kd.prune = rdh::kd::Prune::default();
    }
    base
}

/// Rays by which the tree was not built: those of the file that is named, else those it has itself.
fn unseen(args: &VerifyArgs, accel: &Accel, seed: u64) -> Result<Option<Profile>> {
    let Some(file) = &args.rays else { return Ok(accel.provenance().unseen.clone()) };
    let profile = read_profile(file)?;
    let settings: serde_json::Value = serde_json::from_str(profile.settings())?;
    match settings["set"]["name"].as_str() {
        None => {
            let [_, _, unseen] = profile.split_profiles(accel.provenance().seed.unwrap_or(seed));
            Ok(Some(unseen))
        }
        Some("unseen") => Ok(Some(profile)),
        Some(other) => Err(usage(format!("{}: the {other} set does not judge", file.display()))),
    }
}

/// Aimed rays, and as many unseen ones.
fn samples(args: &VerifyArgs, accel: &Accel, unseen: Option<&Profile>, context: &Context) -> Vec<Ray> {
    /// Tests of triangles that take seconds.
    const TESTS: usize = 1 << 26;
    let count = args.samples.unwrap_or_else(|| (TESTS / accel.mesh().len().max(1)).clamp(64, 4096));
    let mut rays = aimed_rays(accel.mesh(), count, context.seed);
    rays.extend(unseen.into_iter().flat_map(|p| p.samples()).take(count).map(|sample| sample.ray));
    rays
}

fn races(args: &VerifyArgs, accel: &Accel, bases: &[Spec], rays: &Profile) -> Result<Vec<Race>> {
    let judge = if args.counts_only { Judge::Counts } else { Judge::Time { rounds: args.rounds } };
    let against = |spec: &Spec| {
        let base = build(accel.mesh(), spec, &Training::none(), &BuildOptions::default())
            .with_context(|| format!("{spec} can't be built"))?;
        Ok(race(accel, &base, rays, judge, args.margin))
    };
    bases.iter().map(against).collect()
}
