//! What a study is made of, as plain data: `plan.json` in its folder. Whoever has it can go on with the study, or check its shards.

use std::fs;
use std::path::{Path, PathBuf};

use rdh::{BuildOptions, Query, Ray, RayClass, RaySample, Spec, Training};
use rdh_scene::catalog;
use rdh_scene::files::write_whole;
use serde::{Deserialize, Serialize};

use super::experiment::{self, EXPERIMENTS};
use super::lines::uniform_lines;
use super::record::Job;
use super::scope::Scope;
use crate::error::{Error, Result};
use crate::integrate::{Mode, Stage};
use crate::plan::{Plan, refuse_twice};

/// Everything that decides what a study counts, and the jobs that this makes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyPlan {
    /// The version of this format.
    pub version: u32,
    /// The program's version.
    pub program: String,
    /// What the builders make of a small scene, as hashes: other ones make another study.
    #[serde(default)]
    pub builders: String,
    /// What all randomness comes from.
    pub seed: u64,
    /// A first look: small scenes, few views, few rays.
    pub quick: bool,
    /// Width and height of the film.
    pub size: [usize; 2],
    /// Training rays a view, where the experiment doesn't vary them.
    pub training: usize,
    /// Timing rounds in large scenes, and in small ones.
    pub rounds: [usize; 2],
    /// Builds in small scenes.
    pub builds: usize,
    /// The experiments, by name.
    pub experiments: Vec<String>,
    /// The modes.
    pub modes: Vec<Mode>,
    /// Ids of the scenes, and their triangles.
    pub scenes: Vec<(String, usize)>,
    /// The jobs, in order: scene by scene, so that each is loaded once.
    pub jobs: Vec<Job>,
}

impl StudyPlan {
    const VERSION: u32 = 1;
    const FILE: &str = "plan.json";

    /// Plans experiments over a scope; `settings` gives film, training, rounds and seed.
    ///
    /// # Errors
    /// [`Error::Plan`] if there is nothing to do, or a name is unknown or given twice.
    pub fn new(scope: &Scope, experiments: &[String], settings: &Plan) -> Result<Self> {
        let chosen: Vec<&dyn experiment::Experiment> = match experiments {
            [] => EXPERIMENTS.to_vec(),
            names => names.iter().map(|name| known(name)).collect::<Result<_>>()?,
        };
        refuse_twice("experiment", chosen.iter().map(|e| e.name()))?;
        refuse_twice("scene", scope.entries.iter().map(|e| &e.id))?;
        refuse_twice("mode", &scope.modes)?;
        let mut jobs: Vec<Job> = chosen.iter().flat_map(|e| e.jobs(scope)).collect();
        let place = |job: &Job| scope.entries.iter().position(|e| e.id == job.scene);
        jobs.sort_by_key(|job| (place(job), job.frame));
        if jobs.is_empty() {
            return Err(Error::Plan("nothing to do: no experiment has jobs for these scenes and modes".to_owned()));
        }
        Ok(Self {
            version: Self::VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            builders: builders()?,
            seed: settings.seed,
            quick: scope.quick,
            size: settings.size,
            training: settings.training,
            rounds: [settings.rounds, settings.small_rounds],
            builds: settings.small_builds,
            experiments: chosen.iter().map(|e| e.name().to_owned()).collect(),
            modes: scope.modes.clone(),
            scenes: scope.entries.iter().map(|e| (e.id.clone(), e.triangles)).collect(),
            jobs,
        })
    }

    /// The usual film, training and rounds: an even number of these, so that of two structures each begins as often as the other.
    pub fn usual(quick: bool) -> Plan {
        let usual = Plan { rounds: 4, small_rounds: 4, ..Plan::default() };
        if quick {
            Plan { size: [128, 128], training: 4_096, small_builds: 1, ..usual }
        } else {
            Plan { size: [256, 256], small_builds: 2, ..usual }
        }
    }

    /// Film, training, rounds and seed, as measurements take them.
    pub fn settings(&self, threads: Option<usize>) -> Plan {
        Plan {
            size: self.size,
            training: self.training,
            seed: self.seed,
            rounds: self.rounds[0],
            small_rounds: self.rounds[1],
            small_builds: self.builds,
            threads,
            ..Plan::default()
        }
    }

    /// The plan of a study's folder; `None` if there is none.
    ///
    /// # Errors
    /// A file that can't be read, or isn't one.
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let path = Self::path(folder);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(Error::file(&path)(error)),
        };
        let content = |reason: String| Error::Content { path: path.clone(), reason };
        let plan: Self = serde_json::from_str(&text).map_err(|e| content(e.to_string()))?;
        if plan.version != Self::VERSION {
            let known = Self::VERSION;
            return Err(content(format!("version {} of the format; only {known} can be read", plan.version)));
        }
        Ok(Some(plan))
    }

    /// Writes the plan into a study's folder, which is made if it isn't there.
    ///
    /// # Errors
    /// What the system says, with the file.
    pub fn write(&self, folder: &Path) -> Result<()> {
        fs::create_dir_all(folder).map_err(Error::file(folder))?;
        let path = Self::path(folder);
        let text = serde_json::to_string_pretty(self).map_err(|e| Error::Plan(e.to_string()))?;
        write_whole(&path, (text + "\n").as_bytes()).map_err(Error::file(&path))
    }

    /// The first thing in which two plans differ, in words.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let values = |plan: &Self| serde_json::to_value(plan).unwrap_or_default();
        let (here, there) = (values(self), values(other));
        let fields = [
            "program",
            "builders",
            "seed",
            "quick",
            "size",
            "training",
            "rounds",
            "builds",
            "experiments",
            "modes",
            "scenes",
        ];
        let first = fields.into_iter().find(|&f| here[f] != there[f]);
        let words = |f: &str| format!("{f}: {} here, {} there", shortened(&here[f]), shortened(&there[f]));
        first.map(words).or_else(|| (self != other).then(|| "the jobs".to_owned()))
    }

    fn path(folder: &Path) -> PathBuf {
        folder.join(Self::FILE)
    }
}

/// The trees that the main specs grow on a small scene, for uniform lines.
fn builders() -> Result<String> {
    let words = |e: &dyn std::fmt::Display| Error::Plan(format!("the builders can't be told apart: {e}"));
    let entry = catalog::find(SMALL_SCENE, &[]).map_err(|e| words(&e))?;
    let stage = Stage::new(&entry.load(0).map_err(|e| words(&e))?).map_err(|e| words(&e))?;
    let sample = |ray: &Ray| RaySample::new(*ray, None, Query::Closest, RayClass::Other);
    let training = Training::from_samples(uniform_lines(&stage.bounds(), 1024, 1).rays.iter().map(sample).collect());
    let hash = |spec: Spec| {
        let tree = rdh::build(stage.mesh(), &spec, &training, &BuildOptions::default()).map_err(|e| words(&e))?;
        Ok(format!("{spec} {:016x}", tree.fingerprint()))
    };
    Ok(Plan::default_specs().into_iter().map(hash).collect::<Result<Vec<_>>>()?.join(", "))
}

const SMALL_SCENE: &str = "tetra5";

fn known(name: &str) -> Result<&'static dyn experiment::Experiment> {
    let unknown = || Error::Plan(format!("unknown experiment '{name}'; known: {}", experiment::names()));
    experiment::find(name).ok_or_else(unknown)
}

/// As much of a value as fits into a line.
fn shortened(value: &serde_json::Value) -> String {
    const MOST: usize = 120;
    let text = value.to_string();
    if text.chars().count() <= MOST { text } else { text.chars().take(MOST).chain("…".chars()).collect() }
}
