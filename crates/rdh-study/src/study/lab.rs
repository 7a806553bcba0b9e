//! What experiments work with: a scene made ready, its rays, its structures, and the instruments.

use std::fmt;

use rayon::ThreadPool;
use rdh::{Accel, BuildOptions, Mesh, Query, Ray, RayClass, RaySample, Spec, Training};
use rdh_scene::{Entry, View};

use super::lines::uniform_lines;
use super::record::{Job, Record};
use crate::clock::time_thread;
use crate::integrate::{Mode, RayBatch, Shoot, Stage, derived_seed};
use crate::plan::{Case, Plan, Protocol, Target, find_view};
use crate::rows::{Failure, Row};
use crate::run::{Built, Lesson, Load, Site, Trial, build_interleaved, in_pool};

/// A scene at a frame, with a tree that rays are made with.
pub struct Lab<'a> {
    /// Film, training, seed and rounds, for all experiments alike.
    pub plan: &'a Plan,
    /// The scene.
    pub entry: &'a Entry,
    /// The frame.
    pub frame: u32,
    /// The scene, ready for integrators.
    pub stage: Stage,
    /// A `kd+sah`, through which rays are made.
    pub first: Accel,
    views: Vec<View>,
    load: &'a Load,
    pool: Option<&'a ThreadPool>,
}

/// Under which of an experiment's settings something was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// In words; rows of one setting are paired and summarised together.
    pub text: String,
    /// Its place on the experiment's axis, if there is one.
    pub x: Option<f64>,
}

/// A structure in an experiment, and the settings whose tables it stands in.
#[derive(Debug)]
pub struct Entrant<'b> {
    /// The structure.
    pub built: &'b Built,
    /// The settings; a base may stand in several.
    pub settings: Vec<Setting>,
}

impl Setting {
    /// A setting without an axis.
    pub fn named(text: impl Into<String>) -> Self {
        Self { text: text.into(), x: None }
    }

    /// A setting at a place on its axis.
    pub fn at(text: impl Into<String>, x: f64) -> Self {
        Self { text: text.into(), x: Some(x) }
    }
}

impl<'a> Lab<'a> {
    /// Loads a scene at a frame and makes it ready.
    ///
    /// # Errors
    /// What the reader says, in words.
    pub fn open(
        entry: &'a Entry,
        frame: u32,
        plan: &'a Plan,
        load: &'a Load,
        pool: Option<&'a ThreadPool>,
    ) -> Result<Self, String> {
        let scene = load(entry, frame).map_err(|e| e.to_string())?;
        let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
        let views = Target::all(entry.clone()).resolve(&scene.views, || stage.overview())?;
        drop(scene);
        let build = || rdh::build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default());
        let first = in_pool(pool, build).map_err(|e| e.to_string())?;
        Ok(Self { plan, entry, frame, stage, first, views, load, pool })
    }

    /// The same scene at another frame.
    ///
    /// # Errors
    /// As [`Lab::open`].
    pub fn at_frame(&self, frame: u32) -> Result<Self, String> {
        Self::open(self.entry, frame, self.plan, self.load, self.pool)
    }

    /// Another scene, under the same conditions.
    ///
    /// # Errors
    /// As [`Lab::open`].
    pub fn at_scene<'b>(&'b self, entry: &'b Entry) -> Result<Lab<'b>, String> {
        Lab::open(entry, 0, self.plan, self.load, self.pool)
    }

    /// The scene's triangles.
    pub fn mesh(&self) -> &Mesh {
        self.stage.mesh()
    }

    /// A view by name.
    ///
    /// # Errors
    /// An unknown name, with the known ones.
    pub fn view(&self, name: &str) -> Result<View, String> {
        find_view(&self.views, name).cloned()
    }

    /// All views.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// Another view than the named one: the last that the scene has.
    pub fn another_view(&self, name: &str) -> Option<View> {
        self.views.iter().rfind(|v| v.name != name).cloned()
    }

    /// The test rays of a view in a mode, by class.
    pub fn rays(&self, view: &View, mode: Mode) -> Vec<RayBatch> {
        self.rays_on(view, mode, self.plan)
    }

    /// The same on another film.
    pub fn rays_on(&self, view: &View, mode: Mode, plan: &Plan) -> Vec<RayBatch> {
        let shoot = Shoot::new(&self.stage, mode, view, plan);
        in_pool(self.pool, || shoot.batches(&self.first))
    }

    /// A trial in this scene.
    pub fn trial<'t>(&'t self, case: &'t Case, plan: &'t Plan) -> Trial<'t> {
        Trial { case, kind: self.entry.kind, triangles: self.mesh().len(), plan, pool: self.pool }
    }

    /// Training rays of a view in a mode: at most `count`, chosen by `protocol`, which for [`Protocol::Same`] takes all test rays.
    pub fn lesson(&self, view: &View, mode: Mode, protocol: Protocol, count: usize) -> Lesson {
        let plan = Plan { protocol, training: count, ..self.plan.clone() };
        let shoot = Shoot::new(&self.stage, mode, view, &plan);
        let test_rays = match protocol {
            Protocol::Same => self.rays(view, mode).iter().map(|b| b.rays.len()).sum(),
            Protocol::Unseen | Protocol::Paper => 0,
        };
        Lesson::cast(&shoot, &self.first, test_rays, (view, self.frame))
    }

    /// As many uniform lines through the scene's box, cast like rays: what areas assume, to learn from.
    pub fn uniform_lesson(&self, count: usize) -> Lesson {
        let lines = uniform_lines(&self.stage.bounds(), count, derived_seed(self.plan.seed, u64::from(b'L'))).rays;
        let cast = |ray: &Ray| RaySample::new(*ray, self.first.closest(ray), Query::Closest, RayClass::Other);
        let (samples, secs) = time_thread(|| lines.iter().map(cast).collect());
        Lesson { training: Training::from_samples(samples), secs, view: "uniform lines".to_owned(), frame: self.frame }
    }

    /// The scene as a place to cast training rays from any view.
    pub fn site(&self) -> Site<'_> {
        let Self { plan, entry, frame, stage, first, views, load, .. } = self;
        Site { entry, frame: *frame, stage, first, views, plan, load: *load }
    }

    /// A fair sample of at most `count` of the test rays of a view in a mode, with where they end: to weigh trees by, in
    /// place of casting them all.
    pub fn sample(&self, view: &View, mode: Mode, count: usize) -> Training {
        let plan = Plan { protocol: Protocol::Same, ..self.plan.clone() };
        Shoot::new(&self.stage, mode, view, &plan).training(&self.first, count)
    }

    /// Builds structures, timed and in turn; the reasons of those that can't be built go to `found`.
    pub fn build(&self, wanted: &[(Spec, &Lesson)], found: &mut Record) -> Vec<Option<Built>> {
        let results = build_interleaved(self.mesh(), wanted, self.plan.builds_for(self.mesh().len()));
        let told = results.into_iter().zip(wanted).map(|(result, (spec, _))| match result {
            Ok(built) => Some(built),
            Err(reason) => {
                let (scene, view) = (found.job.scene.clone(), Some(found.job.view.clone()));
                found.failures.push(Failure { scene, view, spec: Some(*spec), reason });
                None
            }
        });
        told.collect()
    }

    /// Casts all batches through all structures, counts and times them in turn, and compares their answers; what was found becomes
    /// rows of each entrant's settings. The first entrant of a setting is its base.
    pub fn measure(&self, entrants: &[Entrant<'_>], batches: &[RayBatch], found: &mut Record) {
        let case = case(&found.job);
        let trial = self.trial(&case, self.plan);
        let trees: Vec<&Built> = entrants.iter().map(|e| e.built).collect();
        let outcome = trial.run(&trees, batches);
        found.mismatches.extend(outcome.mismatches);
        for setting in settings(entrants) {
            for (entrant, rows) in entrants.iter().zip(&outcome.rows) {
                if entrant.settings.contains(&setting) {
                    found.rows.extend(rows.iter().map(|row| at(row, &found.job, &setting)));
                }
            }
        }
    }
}

impl fmt::Debug for Lab<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Lab({} at frame {})", self.entry.id, self.frame)
    }
}

fn case(job: &Job) -> Case {
    Case { scene: job.scene.clone(), view: job.view.clone(), frame: job.frame, mode: job.mode }
}

/// What was built, each structure with its settings. A setting whose first structure, its base, could not be built is left out: no other
/// one may take its place.
pub fn entrants<'b>(built: &'b [Option<Built>], settings: &[Vec<Setting>]) -> Vec<Entrant<'b>> {
    let mut bases: Vec<(&Setting, bool)> = Vec::new();
    for (built, settings) in built.iter().zip(settings) {
        for setting in settings {
            if bases.iter().all(|(known, _)| *known != setting) {
                bases.push((setting, built.is_some()));
            }
        }
    }
    let has_base = |setting: &Setting| bases.contains(&(setting, true));
    let entrant = |(built, settings): (&'b Option<Built>, &Vec<Setting>)| {
        let settings: Vec<Setting> = settings.iter().filter(|s| has_base(s)).cloned().collect();
        Some(Entrant { built: built.as_ref()?, settings }).filter(|e| !e.settings.is_empty())
    };
    built.iter().zip(settings).filter_map(entrant).collect()
}

/// A base in all of some settings, and each other structure in one of them, in order.
pub fn beside_base<'b>(built: &'b [Built], settings: &[Setting]) -> Vec<Entrant<'b>> {
    let base = built.first().map(|built| Entrant { built, settings: settings.to_vec() });
    let alone = |(built, setting): (&'b Built, &Setting)| Entrant { built, settings: vec![setting.clone()] };
    base.into_iter().chain(built.iter().skip(1).zip(settings).map(alone)).collect()
}

/// All settings, in the order in which they are first named.
fn settings(entrants: &[Entrant<'_>]) -> Vec<Setting> {
    let mut all: Vec<Setting> = Vec::new();
    for setting in entrants.iter().flat_map(|e| &e.settings) {
        if !all.contains(setting) {
            all.push(setting.clone());
        }
    }
    all
}

fn at(row: &Row, job: &Job, setting: &Setting) -> Row {
    let (experiment, text) = (Some(job.experiment.clone()), Some(setting.text.clone()));
    Row { experiment, setting: text, x: setting.x, ..row.clone() }
}
