//! Runs a plan: scene by scene, view by view, mode by mode, telling each row as soon as it is known.

mod build;
mod case;
mod site;
mod trial;

use rayon::ThreadPool;
use rdh::Spec;
use rdh_scene::{Entry, Note, Scene, View};

use crate::error::{Error, Result};
use crate::integrate::Stage;
use crate::plan::{Case, Plan, Target};
use crate::rows::{Document, Failure, Mismatch, Row};
use crate::summary::summarise;
pub use build::{Built, Lesson, build_interleaved};
pub use site::Site;
pub(crate) use trial::in_pool;
pub use trial::{Outcome, Trial};

/// What a run tells while it goes on.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A scene is in memory.
    Loaded {
        /// Its id.
        scene: &'a str,
        /// The frame.
        frame: u32,
        /// Its triangles.
        triangles: usize,
        /// What its reader dropped or repaired.
        notes: &'a [Note],
    },
    /// Work on a case begins.
    Started {
        /// Which.
        case: &'a Case,
        /// Cases that are behind.
        done: usize,
        /// All cases.
        total: usize,
    },
    /// A structure has been built.
    Built {
        /// The scene's id.
        scene: &'a str,
        /// The structure.
        spec: Spec,
        /// One thread's CPU time.
        secs: f64,
    },
    /// A row is known.
    Row(&'a Row),
    /// Something could not be run; the study goes on.
    Failed(&'a Failure),
    /// Two structures disagree; the study goes on.
    Mismatch(&'a Mismatch),
}

/// Runs all cases of a plan. What goes wrong with one scene stands in the document and doesn't stop the others.
///
/// In memory are one scene, its trees that need no rays, and the trees of the current view and mode that do.
///
/// # Errors
/// A plan that can't be run at all.
pub fn run(plan: &Plan, observer: &mut dyn FnMut(&Event<'_>)) -> Result<Document> {
    run_loading(plan, &Entry::load, observer)
}

/// [`run`], with scenes from elsewhere: `load` gets an entry and a frame.
///
/// # Errors
/// A plan that can't be run at all.
pub fn run_loading(plan: &Plan, load: &Load, observer: &mut dyn FnMut(&Event<'_>)) -> Result<Document> {
    plan.check()?;
    let document = Document {
        version: Document::VERSION,
        rows: Vec::new(),
        summary: Vec::new(),
        failures: Vec::new(),
        mismatches: Vec::new(),
        curves: Vec::new(),
    };
    let total = plan.cases().len();
    let mut study = Study { plan, load, observer, pool: pool(plan.threads)?, document, done: 0, total };
    for target in &plan.targets {
        for &frame in &target.frames {
            study.scene(target, frame);
        }
    }
    let mut document = study.document;
    document.summary = summarise(&document.rows, &plan.specs[0]);
    Ok(document)
}

/// Reads or makes a scene at a frame.
pub type Load = dyn Fn(&Entry, u32) -> rdh_scene::Result<Scene> + Sync;

pub(crate) fn pool(threads: Option<usize>) -> Result<Option<ThreadPool>> {
    let start = |count: usize| {
        let started = rayon::ThreadPoolBuilder::new().num_threads(count).build();
        started.map_err(|e| Error::Threads { count, reason: e.to_string() })
    };
    threads.map(start).transpose()
}

struct Study<'p, 'o> {
    plan: &'p Plan,
    load: &'p Load,
    observer: &'o mut dyn FnMut(&Event<'_>),
    pool: Option<ThreadPool>,
    document: Document,
    done: usize,
    total: usize,
}

/// A scene in a frame, with its trees that need no rays.
struct Prepared<'t> {
    target: &'t Target,
    frame: u32,
    stage: Stage,
    /// All views, wanted or not.
    views: Vec<View>,
    shared: Vec<Built>,
    /// The tree that rays are made with, if no spec of the plan can: it counts nowhere.
    helper: Option<Built>,
}

impl Prepared<'_> {
    /// The tree that rays are made with.
    fn first(&self) -> Option<&rdh::Accel> {
        self.shared.first().or(self.helper.as_ref()).map(|b| &b.accel)
    }
}

impl Study<'_, '_> {
    fn scene(&mut self, target: &Target, frame: u32) {
        let expected = target.views_expected() * self.plan.modes.len();
        match self.prepare(target, frame) {
            Ok((prepared, views)) => {
                self.total = self.total - expected + views.len() * self.plan.modes.len();
                for view in &views {
                    for &mode in &self.plan.modes {
                        self.case(&prepared, view, mode);
                        self.done += 1;
                    }
                }
            }
            Err(reason) => {
                self.fail(Failure { scene: target.entry.id.clone(), view: None, spec: None, reason });
                self.done += expected;
            }
        }
    }

    fn prepare<'t>(&mut self, target: &'t Target, frame: u32) -> Result<(Prepared<'t>, Vec<View>), String> {
        let scene = (self.load)(&target.entry, frame).map_err(|e| e.to_string())?;
        let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
        let triangles = stage.mesh().len();
        (self.observer)(&Event::Loaded { scene: &target.entry.id, frame, triangles, notes: &scene.notes });
        let views = target.resolve(&scene.views, || stage.overview())?;
        let all = Target::all(target.entry.clone()).resolve(&scene.views, || stage.overview())?;
        // The mesh is in the stage now; two copies of a large scene would be one too many.
        drop(scene);
        let mut prepared = Prepared { target, frame, stage, views: all, shared: Vec::new(), helper: None };
        let needs_no_rays: Vec<Spec> = self.plan.specs.iter().filter(|s| !s.needs_rays()).copied().collect();
        prepared.shared = self.build_all(&prepared, None, &needs_no_rays, &Lesson::none());
        if prepared.shared.is_empty() {
            prepared.helper = self.build_all(&prepared, None, &[Spec::default()], &Lesson::none()).pop();
        }
        Ok((prepared, views))
    }

    fn fail_case(&mut self, on: &Prepared<'_>, view: Option<&str>, spec: Option<Spec>, reason: String) {
        self.fail(Failure { scene: on.target.entry.id.clone(), view: view.map(str::to_owned), spec, reason });
    }

    fn fail(&mut self, failure: Failure) {
        (self.observer)(&Event::Failed(&failure));
        self.document.failures.push(failure);
    }
}
