//! One choice: a view of a scene and its rays.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use rdh::tune::{Confirmed, Evidence, confirm};
use rdh::{Accel, BuildOptions, Profile, Provenance, Spec, Training, TuneOptions};
use rdh_scene::saved;
use rdh_study::Mode;
use rdh_study::clock::process_nanos;
use serde::Serialize;
use serde_json::json;

use crate::args::TuneArgs;
use crate::commands::rays;
use crate::commands::record::record;
use crate::context::Context;
use crate::staged::Staged;

/// Where rays come from.
#[derive(Debug)]
pub(super) enum Source {
    Mode(Mode),
    File(PathBuf, Box<Profile>),
}

/// What was chosen for a view's rays, and why.
#[derive(Debug, Serialize)]
pub(super) struct Case {
    pub(super) scene: String,
    pub(super) view: String,
    /// The mode, or the file of the profile.
    pub(super) rays: String,
    pub(super) triangles: usize,
    pub(super) seed: u64,
    pub(super) evidence: Evidence,
    /// The choice on the third set; null if nothing was gained, or there were too few rays.
    pub(super) unseen: Option<Confirmed>,
    /// Whether it is surely slower there, at the risk of all cases together.
    pub(super) slower: bool,
}

/// The tree that rays are recorded through.
const FIRST: &str = "bvh8+sah";

impl Source {
    pub(super) fn name(&self) -> String {
        match self {
            Self::Mode(mode) => mode.to_string(),
            Self::File(file, _) => file.display().to_string(),
        }
    }

    fn profile(&self, staged: &Staged, args: &TuneArgs, seed: u64) -> Result<Profile> {
        match self {
            Self::File(file, profile) => {
                rays::warn_of_other_scene(file, &serde_json::from_str(profile.settings())?, &staged.scene);
                Ok(profile.as_ref().clone())
            }
            Self::Mode(mode) => {
                let first: Spec = FIRST.parse()?;
                let accel = staged.build(&first, &Training::none())?;
                Ok(record(staged, *mode, args.size, args.capacity, seed, &accel))
            }
        }
    }
}

impl Case {
    /// Whether the choice turns out wrong, at a risk of `risk`.
    pub(super) fn judge(&mut self, risk: f64) {
        self.slower = self.unseen.as_ref().is_some_and(|unseen| unseen.is_slower(risk));
    }
}

/// Records the rays, chooses, and looks at the choice on the third set.
pub(super) fn tune(
    staged: &Staged,
    source: &Source,
    candidates: &[Spec],
    args: &TuneArgs,
    context: &Context,
) -> Result<Case> {
    let profile = source.profile(staged, args, context.seed)?;
    let (training, held_out, unseen) = profile.clone().split(context.seed);
    let options = TuneOptions {
        build: BuildOptions { max_bytes: args.max_mb, ..BuildOptions::default() },
        max_build_secs: args.max_build_secs,
        class_weights: args.weights.0,
        rounds: args.rounds,
        ..TuneOptions::default()
    };
    // The process's CPU time: builds run on all threads, rays on this one alone.
    let clock = || process_nanos();
    let clock: Option<rdh::tune::Clock<'_>> = if args.counts_only { None } else { Some(&clock) };
    let mesh = staged.stage.mesh();
    let tuned = rdh::tune(mesh, candidates, &training, &held_out, &options, clock)
        .with_context(|| format!("{} can't be tuned", staged.name()))?;
    let unseen = confirm(&tuned, &unseen, &options, clock)?;
    if let Some(file) = &args.output {
        let [_, _, unseen] = profile.split_profiles(context.seed);
        save(file, tuned.accel, staged, source, unseen, context.seed)?;
    }
    Ok(Case {
        scene: staged.scene.clone(),
        view: staged.view.name.clone(),
        rays: source.name(),
        triangles: mesh.len(),
        seed: context.seed,
        evidence: tuned.evidence,
        unseen,
        slower: false,
    })
}

/// Writes the structure with what it was made for, and the rays that may judge it; the evidence is there already.
fn save(file: &Path, accel: Accel, staged: &Staged, source: &Source, unseen: Profile, seed: u64) -> Result<()> {
    let settings = json!({
        "program": concat!("rdh ", env!("CARGO_PKG_VERSION")),
        "scene": *staged.setting,
        "view": staged.view.name,
        "frame": staged.frame,
        "rays": source.name(),
    });
    let (seed, unseen) = (Some(seed), Some(unseen));
    let provenance = Provenance { seed, settings, unseen, ..accel.provenance().clone() };
    Ok(saved::save(&accel.with_provenance(provenance), file)?)
}
