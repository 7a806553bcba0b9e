//! `rdh rays`: what profiles hold; merging, thinning, splitting.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use rdh::{Aabb, Profile, Query};
use rdh_scene::saved;
use serde::Serialize;
use serde_json::{Value, json};

use crate::args::RaysArgs;
use crate::context::Context;
use crate::exit::usage;
use crate::output::{print, print_json, write_file};
use crate::table::{Table, short_coordinate};

/// Reads the profiles, does what is asked, and describes the result.
pub(crate) fn run(args: &RaysArgs, context: &Context) -> Result<()> {
    let profiles: Vec<_> = args.files.iter().map(|file| Ok((file.clone(), read(file)?))).collect::<Result<_>>()?;
    let described = match &args.output {
        None => profiles,
        Some(output) => transform(args, context.seed, profiles, output)?,
    };
    let mut document = json!({ "version": 1, "files": described.iter().map(describe).collect::<Vec<_>>() });
    let drift = args.drift.as_deref().map(|file| Ok::<_, anyhow::Error>((file, read_base(file)?))).transpose()?;
    let drifts: Vec<_> = drift.iter().flat_map(|base| described.iter().map(|p| drifted(p, base))).collect();
    if drift.is_some() {
        document["drifts"] = json!(drifts);
    }
    if context.json {
        return print_json(&document);
    }
    print(&(described_text(&described, context) + &drift_text(&drifts, context)))
}

pub(crate) fn read(file: &Path) -> Result<Profile> {
    let name = || file.display().to_string();
    let bytes = fs::read(file).with_context(name)?;
    Profile::from_bytes(&bytes).with_context(name)
}

/// A profile, or the rays that a saved tree was not built by, but might have been.
fn read_base(file: &Path) -> Result<Profile> {
    if !file.extension().is_some_and(|e| e.eq_ignore_ascii_case("rdh")) {
        return read(file);
    }
    let unseen = saved::open(file)?.provenance().unseen.clone();
    unseen.with_context(|| {
        format!("{} holds no rays: it was built without any, or by a training set alone", file.display())
    })
}

/// Says so if a profile was recorded in another scene, by its settings, as far as these tell: rays of one scene mean nothing in another.
pub(crate) fn warn_of_other_scene(file: &Path, settings: &Value, scene: &str) {
    let Some(recorded) = settings["scene"].as_str() else { return };
    let is_id = |name: &str| !name.contains(['.', '/', '\\']);
    if recorded != scene && is_id(recorded) && is_id(scene) {
        tracing::warn!("{} was recorded in {recorded}, not in {scene}", file.display());
    }
}

type Named = (PathBuf, Profile);

/// Merges, thins and splits, in this order, and writes the result.
fn transform(args: &RaysArgs, seed: u64, profiles: Vec<Named>, output: &Path) -> Result<Vec<Named>> {
    if !args.merge && args.thin.is_none() && !args.split {
        return Err(usage("--output needs --merge, --thin N or --split"));
    }
    if profiles.len() > 1 && !args.merge {
        return Err(usage("several files go into one profile only with --merge"));
    }
    let whole = Profile::merge(profiles.into_iter().map(|(_, p)| p)).context("the profiles can't be merged")?;
    let whole = args.thin.map_or_else(|| whole.clone(), |n| whole.clone().thin(n));
    let written = if args.split { split(whole, seed, output)? } else { vec![(output.to_owned(), whole)] };
    for (file, profile) in &written {
        write_file(file, &profile.to_bytes())?;
    }
    Ok(written)
}

/// The three sets as profiles of their own, with the set's name in the settings.
fn split(whole: Profile, seed: u64, output: &Path) -> Result<Vec<Named>> {
    let named = |(name, profile): (&str, Profile)| {
        let mut settings: Value = serde_json::from_str(profile.settings())?;
        if let Some(object) = settings.as_object_mut() {
            object.insert("set".to_owned(), json!({ "name": name, "split_seed": seed }));
        }
        Ok((set_name(output, name), profile.with_settings(&settings.to_string())?))
    };
    ["training", "held-out", "unseen"].into_iter().zip(whole.split_profiles(seed)).map(named).collect()
}

/// `a.rays` becomes `a.training.rays`.
fn set_name(output: &Path, set: &str) -> PathBuf {
    output.with_extension(format!("{set}.{}", output.extension().unwrap_or("rays".as_ref()).to_string_lossy()))
}

/// A profile for `--json`.
#[derive(Serialize)]
struct Described {
    file: String,
    samples: usize,
    seen: u64,
    invalid: u64,
    rate: f64,
    seed: u64,
    origins_min: Option<[f32; 3]>,
    origins_max: Option<[f32; 3]>,
    settings: Value,
    groups: Vec<Group>,
}

/// The samples of one class and query.
#[derive(Serialize)]
struct Group {
    class: &'static str,
    query: &'static str,
    samples: usize,
    weight: u64,
    hit_share: f64,
    origins_min: Option<[f32; 3]>,
    origins_max: Option<[f32; 3]>,
    direction_mean: [f32; 3],
}

fn describe((file, profile): &Named) -> Described {
    let summary = profile.summary();
    let group = |g: &rdh::rays::Group| Group {
        class: g.class.name(),
        query: query_name(g.query),
        samples: g.samples,
        weight: g.weight,
        hit_share: g.hit_share,
        origins_min: corners(&g.origins).map(|(min, _)| min),
        origins_max: corners(&g.origins).map(|(_, max)| max),
        direction_mean: g.direction_mean,
    };
    Described {
        file: file.display().to_string(),
        samples: profile.len(),
        seen: summary.seen,
        invalid: summary.invalid,
        rate: summary.rate,
        seed: profile.seed(),
        origins_min: corners(&summary.origins).map(|(min, _)| min),
        origins_max: corners(&summary.origins).map(|(_, max)| max),
        settings: serde_json::from_str(profile.settings()).unwrap_or(Value::Null),
        groups: summary.groups.iter().map(group).collect(),
    }
}

/// How far a profile's rays are from another one's.
#[derive(Serialize)]
struct Drifted {
    file: String,
    from: String,
    #[serde(flatten)]
    drift: Option<Drift>,
}

/// A drift for `--json`.
#[derive(Serialize)]
pub(crate) struct Drift {
    drift: f64,
    p_value: f64,
    origins: f64,
    directions: f64,
    lengths: f64,
    kinds: f64,
    rays: [usize; 2],
}

fn drifted((file, profile): &Named, (base_file, base): &(&Path, Profile)) -> Drifted {
    let drift = Drift::between(base, profile);
    Drifted { file: file.display().to_string(), from: base_file.display().to_string(), drift }
}

impl Drift {
    /// How far `profile`'s rays are from those of `base`.
    pub(crate) fn between(base: &Profile, profile: &Profile) -> Option<Self> {
        base.drift(profile).map(|d| Self {
            drift: d.distance,
            p_value: d.p_value,
            origins: d.origins,
            directions: d.directions,
            lengths: d.lengths,
            kinds: d.kinds,
            rays: d.rays,
        })
    }

    /// In a line.
    pub(crate) fn text(&self, from: &str) -> String {
        format!("drift {:.3} (p = {:.3}) from {from}: {}", self.drift, self.p_value, self.verdict())
    }

    fn verdict(&self) -> &'static str {
        if self.p_value < 0.01 { "other rays" } else { "no clear difference" }
    }
}

fn drift_text(drifts: &[Drifted], context: &Context) -> String {
    let Some(first) = drifts.first() else { return String::new() };
    let mut table = Table::new(&["file", ">drift", ">p", ">origins", ">directions", ">lengths", ">kinds", "  "]);
    for d in drifts {
        let Some(drift) = &d.drift else {
            table.push(vec![d.file.clone().into(), "no rays".into()]);
            continue;
        };
        let mut row =
            vec![d.file.clone().into(), format!("{:.3}", drift.drift).into(), format!("{:.3}", drift.p_value).into()];
        row.extend([drift.origins, drift.directions, drift.lengths, drift.kinds].map(|x| format!("{x:.3}").into()));
        row.push(drift.verdict().into());
        table.push(row);
    }
    let text = table.text(context.styles.head);
    format!(
        "\ndrift from {}: 0 the same rays, 1 nothing in common; p: the chance of it if they are the same\n{text}",
        first.from
    )
}

fn corners(bounds: &Aabb) -> Option<([f32; 3], [f32; 3])> {
    (!bounds.is_empty()).then_some((bounds.min, bounds.max))
}

fn query_name(query: Query) -> &'static str {
    match query {
        Query::Closest => "closest",
        Query::Occluded => "occluded",
        Query::All => "all",
    }
}

fn described_text(profiles: &[Named], context: &Context) -> String {
    profiles.iter().map(|p| profile_text(&describe(p), context)).collect::<Vec<_>>().join("\n")
}

fn profile_text(d: &Described, context: &Context) -> String {
    let mut table = Table::new(&["  class", "query", ">samples", ">rays", ">hits", "mean direction", "origins"]);
    for g in &d.groups {
        table.push(vec![
            format!("  {}", g.class).into(),
            g.query.into(),
            g.samples.to_string().into(),
            g.weight.to_string().into(),
            format!("{:.1} %", 100.0 * g.hit_share).into(),
            g.direction_mean.map(|x| short_coordinate(x.into())).join(" ").into(),
            box_text(g.origins_min, g.origins_max).into(),
        ]);
    }
    let invalid = if d.invalid > 0 { format!(", {} of them invalid", d.invalid) } else { String::new() };
    let rate = if d.rate < 1.0 { format!(", 1 in {:.1} distinct rays", 1.0 / d.rate) } else { String::new() };
    let head = format!("{}: {} samples of {} rays{invalid}{rate}, seed {}\n", d.file, d.samples, d.seen, d.seed);
    let settings = if d.settings == json!({}) { String::new() } else { format!("  {}\n", d.settings) };
    head + &settings + &table.text(context.styles.head)
}

fn box_text(min: Option<[f32; 3]>, max: Option<[f32; 3]>) -> String {
    let (Some(min), Some(max)) = (min, max) else { return "none".to_owned() };
    let side = |a: usize| {
        let [low, high] = [min[a], max[a]].map(|x| short_coordinate(x.into()));
        if low == high { low } else { format!("{low}..{high}") }
    };
    [0, 1, 2].map(side).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_after_the_output() {
        assert_eq!(set_name(Path::new("x/a.rays"), "held-out"), Path::new("x/a.held-out.rays"));
        assert_eq!(set_name(Path::new("a"), "unseen"), Path::new("a.unseen.rays"));
    }
}
