//! Runs a plan: scene by scene, view by view, mode by mode, telling each row as soon as it is known.

use rayon::ThreadPool;
use rdh::{BuildOptions, Spec, Training};
use rdh_scene::{Entry, Note, Scene, View};

use crate::clock::{time_process, time_thread};
use crate::error::{Error, Result};
use crate::integrate::{Mode, RayBatch, Shoot, Stage};
use crate::measure::{Tally, difference, tally, time_interleaved};
use crate::plan::{Case, Plan, Target};
use crate::rows::{Document, Failure, Mismatch, Row};
use crate::stats::median;
use crate::summary::summarise;

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
pub type Load = dyn Fn(&Entry, u32) -> rdh_scene::Result<Scene>;

fn pool(threads: Option<usize>) -> Result<Option<ThreadPool>> {
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

/// A finished structure and what it took.
struct Built {
    spec: Spec,
    accel: rdh::Accel,
    build_secs: f64,
}

/// A scene in a frame, with its trees that need no rays.
struct Prepared<'t> {
    target: &'t Target,
    frame: u32,
    stage: Stage,
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
        // The mesh is in the stage now; two copies of a large scene would be one too many.
        drop(scene);
        let mut prepared = Prepared { target, frame, stage, shared: Vec::new(), helper: None };
        let needs_no_rays: Vec<Spec> = self.plan.specs.iter().filter(|s| !s.needs_rays()).copied().collect();
        prepared.shared = self.build_all(&prepared, None, &needs_no_rays, &Training::none());
        if prepared.shared.is_empty() {
            prepared.helper = self.build_all(&prepared, None, &[Spec::default()], &Training::none()).pop();
        }
        Ok((prepared, views))
    }

    /// Builds some specs, several times and interleaved in small scenes. Those that fail are told and left out.
    fn build_all(&mut self, on: &Prepared<'_>, view: Option<&str>, specs: &[Spec], training: &Training) -> Vec<Built> {
        let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
        let mut accels: Vec<Option<rdh::Accel>> = specs.iter().map(|_| None).collect();
        let mut secs = vec![Vec::new(); specs.len()];
        let mut failed = vec![false; specs.len()];
        for round in 0..self.plan.builds_for(on.stage.mesh().len()) {
            for turn in 0..specs.len() {
                let i = (turn + round) % specs.len();
                if failed[i] {
                    continue;
                }
                // The old one goes first: two of a large scene's trees would not fit.
                accels[i] = None;
                match time_process(|| rdh::build(on.stage.mesh(), &specs[i], training, &options)) {
                    (Ok(accel), time) => {
                        accels[i] = Some(accel);
                        secs[i].push(time);
                    }
                    (Err(error), _) => {
                        failed[i] = true;
                        self.fail_case(on, view, Some(specs[i]), error.to_string());
                    }
                }
            }
        }
        let finished = specs
            .iter()
            .zip(accels)
            .zip(&secs)
            .filter_map(|((&spec, accel), secs)| Some(Built { spec, accel: accel?, build_secs: median(secs) }));
        let finished: Vec<Built> = finished.collect();
        for built in &finished {
            let scene = &on.target.entry.id;
            (self.observer)(&Event::Built { scene, spec: built.spec, secs: built.build_secs });
        }
        finished
    }

    fn case(&mut self, on: &Prepared<'_>, view: &View, mode: Mode) {
        let case = Case { scene: on.target.entry.id.clone(), view: view.name.clone(), frame: on.frame, mode };
        (self.observer)(&Event::Started { case: &case, done: self.done, total: self.total });
        let Some(first) = on.first() else {
            return self.fail_case(on, Some(&view.name), None, "no structure to make the rays with".to_owned());
        };
        let shoot = Shoot::new(&on.stage, mode, view, self.plan);
        let batches = self.in_pool(|| shoot.batches(first));
        let needs_rays: Vec<Spec> = self.plan.specs.iter().filter(|s| s.needs_rays()).copied().collect();
        let test_rays = batches.iter().map(|b| b.rays.len()).sum();
        let (training, rrs_secs) = match needs_rays.is_empty() {
            true => (Training::none(), 0.0),
            false => time_thread(|| shoot.training(first, test_rays)),
        };
        let trained = self.build_all(on, Some(&view.name), &needs_rays, &training);
        let trees: Vec<&Built> = self.plan.specs.iter().filter_map(|s| find(&on.shared, &trained, s)).collect();
        if trees.is_empty() {
            return;
        }
        let tallies = self.tally_all(&case, &trees, &batches);
        let accels: Vec<&rdh::Accel> = trees.iter().map(|t| &t.accel).collect();
        let times = time_interleaved(&accels, &batches, self.plan.rounds_for(on.stage.mesh().len()));
        for (i, tree) in trees.iter().enumerate() {
            for (j, batch) in batches.iter().enumerate() {
                let row = row(self.plan, on, &case, tree, batch, &tallies[i][j], &times[i][j], rrs_secs);
                (self.observer)(&Event::Row(&row));
                self.document.rows.push(row);
            }
        }
    }

    /// Counts of `[tree][batch]`; disagreements with the first tree are told.
    fn tally_all(&mut self, case: &Case, trees: &[&Built], batches: &[RayBatch]) -> Vec<Vec<Tally>> {
        let mut tallies: Vec<Vec<Tally>> = trees.iter().map(|_| Vec::new()).collect();
        for batch in batches {
            let base = self.in_pool(|| tally(&trees[0].accel, batch));
            for (i, tree) in trees.iter().enumerate().skip(1) {
                let mut other = self.in_pool(|| tally(&tree.accel, batch));
                if let Some(mismatch) = mismatch(case, batch, (tree.spec, &other), (trees[0].spec, &base)) {
                    (self.observer)(&Event::Mismatch(&mismatch));
                    self.document.mismatches.push(mismatch);
                }
                other.answers = Vec::new();
                tallies[i].push(other);
            }
            tallies[0].push(Tally { answers: Vec::new(), ..base });
        }
        tallies
    }

    fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    fn fail_case(&mut self, on: &Prepared<'_>, view: Option<&str>, spec: Option<Spec>, reason: String) {
        self.fail(Failure { scene: on.target.entry.id.clone(), view: view.map(str::to_owned), spec, reason });
    }

    fn fail(&mut self, failure: Failure) {
        (self.observer)(&Event::Failed(&failure));
        self.document.failures.push(failure);
    }
}

fn find<'b>(shared: &'b [Built], trained: &'b [Built], spec: &Spec) -> Option<&'b Built> {
    shared.iter().chain(trained).find(|b| b.spec == *spec)
}

fn mismatch(case: &Case, batch: &RayBatch, other: (Spec, &Tally), base: (Spec, &Tally)) -> Option<Mismatch> {
    let difference = difference(other.1, base.1)?;
    let ray = &batch.rays[difference.first];
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    Some(Mismatch {
        scene: case.scene.clone(),
        view: case.view.clone(),
        mode: case.mode,
        class: batch.class,
        spec: other.0,
        base: base.0,
        rays: difference.rays,
        first_ray: difference.first,
        ray: [ox, oy, oz, dx, dy, dz],
        t_max: Some(ray.t_max).filter(|t| t.is_finite()),
        answer: other.1.answers[difference.first].hit(),
        base_answer: base.1.answers[difference.first].hit(),
    })
}

#[expect(clippy::too_many_arguments, reason = "a row is where everything comes together")]
fn row(
    plan: &Plan,
    on: &Prepared<'_>,
    case: &Case,
    tree: &Built,
    batch: &RayBatch,
    tally: &Tally,
    secs: &[f64],
    rrs_secs: f64,
) -> Row {
    let rays = batch.rays.len() as f64;
    let round_nanos_per_ray: Vec<f64> = secs.iter().map(|s| s * 1e9 / rays).collect();
    let (stats, trained) = (tree.accel.stats(), tree.spec.needs_rays());
    Row {
        scene: case.scene.clone(),
        view: case.view.clone(),
        frame: case.frame,
        kind: on.target.entry.kind,
        mode: case.mode,
        class: batch.class,
        spec: tree.spec,
        triangles: on.stage.mesh().len(),
        rays: batch.rays.len() as u64,
        hits: tally.hits,
        t_sum: tally.t_sum,
        trained_on: stats.trained_on,
        train_view: trained.then(|| case.view.clone()),
        train_frame: trained.then_some(case.frame),
        steps_per_ray: tally.counts.steps() as f64 / rays,
        tests_per_ray: tally.counts.tests as f64 / rays,
        empty_leaves_per_ray: tally.counts.empty_leaves as f64 / rays,
        nanos_per_ray: median(&round_nanos_per_ray),
        round_nanos_per_ray,
        build_secs: tree.build_secs,
        rrs_secs: if trained { rrs_secs } else { 0.0 },
        nodes: stats.nodes,
        references: stats.references,
        bytes: stats.bytes,
        depth: stats.depth,
        protocol: plan.protocol,
        seed: plan.seed,
    }
}
