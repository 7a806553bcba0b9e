//! What a study is made of, as plain data: `plan.json` in its folder. Whoever has it can go on with the study, or check its shards.

use std::fs;
use std::path::{Path, PathBuf};

use rdh_scene::Entry;
use serde::{Deserialize, Serialize};

use super::experiment::{self, EXPERIMENTS};
use super::record::Job;
use super::scope::Scope;
use crate::error::{Error, Result};
use crate::files::write_whole;
use crate::integrate::Mode;
use crate::plan::Plan;

/// Everything that decides what a study counts, and the jobs that this makes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyPlan {
    /// The version of this format.
    pub version: u32,
    /// The program's version.
    pub program: String,
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
        let twice = |i: usize| chosen[..i].iter().any(|e| e.name() == chosen[i].name());
        if let Some(i) = (0..chosen.len()).find(|&i| twice(i)) {
            return Err(Error::Plan(format!("experiment '{}' is given twice", chosen[i].name())));
        }
        let mut jobs: Vec<Job> = chosen.iter().flat_map(|e| e.jobs(scope)).collect();
        let place = |job: &Job| scope.entries.iter().position(|e| e.id == job.scene);
        jobs.sort_by_key(|job| (place(job), job.frame));
        if jobs.is_empty() {
            return Err(Error::Plan("nothing to do: no experiment has jobs for these scenes and modes".to_owned()));
        }
        Ok(Self {
            version: Self::VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
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
        let differs = |what: &str, ours: String, theirs: String| {
            (ours != theirs).then(|| format!("{what}: {} here, {} there", shortened(&ours), shortened(&theirs)))
        };
        let both = |of: fn(&Self) -> String| (of(self), of(other));
        let parts: [(&str, fn(&Self) -> String); 11] = [
            ("version of the program", |p| p.program.clone()),
            ("seed", |p| p.seed.to_string()),
            ("quick", |p| p.quick.to_string()),
            ("size", |p| format!("{:?}", p.size)),
            ("training", |p| p.training.to_string()),
            ("rounds", |p| format!("{:?}", p.rounds)),
            ("builds", |p| p.builds.to_string()),
            ("experiments", |p| p.experiments.join(", ")),
            ("modes", |p| p.modes.iter().map(Mode::to_string).collect::<Vec<_>>().join(", ")),
            ("scenes", |p| p.scenes.iter().map(|(id, n)| format!("{id} ({n})")).collect::<Vec<_>>().join(", ")),
            ("jobs", |p| format!("{} jobs", p.jobs.len())),
        ];
        let first = parts.iter().find_map(|(what, of)| {
            let (ours, theirs) = both(*of);
            differs(what, ours, theirs)
        });
        first.or_else(|| (self != other).then(|| "the jobs".to_owned()))
    }

    /// The entries of the plan's scenes, in order, out of those that there are.
    ///
    /// # Errors
    /// A scene that isn't there, or has another number of triangles than when the study was planned.
    pub fn entries(&self, known: &[Entry]) -> Result<Vec<Entry>> {
        let find = |(id, triangles): &(String, usize)| {
            let missing = || Error::Plan(format!("scene '{id}' of the study isn't there; is --scenes DIR missing?"));
            let entry = known.iter().find(|e| e.id == *id).ok_or_else(missing)?;
            if entry.triangles != *triangles {
                let reason = format!("scene '{id}' has {} triangles; when planned it had {triangles}", entry.triangles);
                return Err(Error::Plan(reason));
            }
            Ok(entry.clone())
        };
        self.scenes.iter().map(find).collect()
    }

    fn path(folder: &Path) -> PathBuf {
        folder.join(Self::FILE)
    }
}

fn known(name: &str) -> Result<&'static dyn experiment::Experiment> {
    let unknown = || Error::Plan(format!("unknown experiment '{name}'; known: {}", experiment::names()));
    experiment::find(name).ok_or_else(unknown)
}

fn shortened(text: &str) -> String {
    const MOST: usize = 120;
    if text.chars().count() <= MOST { text.to_owned() } else { text.chars().take(MOST).chain("…".chars()).collect() }
}
