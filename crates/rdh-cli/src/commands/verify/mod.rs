//! `rdh verify`: a saved tree, proved.

mod text;

use anyhow::{Context as _, Error, Result};
use rdh::tune::{Confirmed, Evidence, confirm_against};
use rdh::{Accel, BuildOptions, Profile, Ray, Spec, StructureSpec, Training, TuneOptions, Unseen, build};
use rdh_scene::saved;
use rdh_study::clock::thread_nanos;
use rdh_study::verify::{Agreement, agreement, aimed_rays};
use serde::Serialize;

use super::rays::{self, Drift};
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
    /// How far the rays of --rays are from those that the tree was made for.
    drift: Option<Drift>,
    /// One a base; none without unseen rays, or for a tree that was built by areas itself.
    races: Vec<Race>,
    ok: bool,
}

/// The tree against one that was built by areas, on unseen rays.
#[derive(Serialize)]
struct Race {
    base: Spec,
    /// Nothing if there were too few rays to say anything.
    found: Option<Confirmed>,
    /// Whether it is surely slower, and by more than the margin.
    slower: bool,
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
    let ok = right && !races.iter().any(|race| race.slower);
    let file = args.tree.display().to_string();
    let drift = drift(args, &accel, unseen.as_ref());
    let verified = Verified { version: 1, file, stats: *accel.stats(), faults, brute_force, drift, races, ok };
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
        None => vec![evidence(accel).map_or_else(|| by_areas(&spec), |evidence| evidence.base)],
    };
    if let Some(base) = bases.iter().find(|base| base.needs_rays()) {
        return Err(usage(format!("{base} is not built by areas alone")));
    }
    Ok(bases.into_iter().filter(|base| *base != spec).collect())
}

/// Why it was chosen, if `tune` did.
fn evidence(accel: &Accel) -> Option<Evidence> {
    serde_json::from_value(accel.provenance().evidence.clone()?).ok()
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
    let profile = rays::read(file)?;
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

/// How far the rays that are given are from those that the tree has itself.
fn drift(args: &VerifyArgs, accel: &Accel, given: Option<&Profile>) -> Option<Drift> {
    args.rays.as_ref()?;
    Drift::between(accel.provenance().unseen.as_ref()?, given?)
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
    let unseen = Unseen::from_samples(rays.samples().to_vec());
    let options = TuneOptions { rounds: args.rounds, ..TuneOptions::default() };
    let clock = || thread_nanos();
    let clock: Option<rdh::tune::Clock<'_>> = if args.counts_only { None } else { Some(&clock) };
    let against = |&base: &Spec| {
        let by_areas = build(accel.mesh(), &base, &Training::none(), &BuildOptions::default())
            .with_context(|| format!("{base} can't be built"))?;
        let found = confirm_against(accel, &by_areas, &unseen, &options, clock)?;
        // All bases together are one question.
        let surely = |found: &Confirmed| found.is_slower(options.risk / bases.len() as f64);
        let far = |found: &Confirmed| found.time.as_ref().unwrap_or(&found.counts).ratio > 1.0 + args.margin;
        let slower = found.as_ref().is_some_and(|found| surely(found) && far(found));
        Ok(Race { base, found, slower })
    };
    bases.iter().map(against).collect()
}
