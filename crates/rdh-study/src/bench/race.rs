//! One scene: rays are made, structures built, answers compared, and then rounds timed, interleaved.

use std::path::Path;

use rdh::{Accel, BuildOptions, Recorder, Spec, Training};

use super::BenchEvent;
use super::columns::{Column, Film, Frame};
use super::files;
use super::heat::{Heat, Outcome};
use super::lanes::{Batch, Key, Lane, Ours, groups};
use super::memory;
use super::plan::BenchPlan;
use super::process::{Process, Trouble};
use super::registry::Pace;
use super::rows::{BenchDocument, BenchFailure, Record, Skipped};
use super::verify::Answers;
use crate::clock::time_process;
use crate::integrate::{Lens, Mode, Stage};
use crate::plan::Target;

type See<'s> = &'s mut dyn FnMut(&BenchEvent<'_>);

/// Training rays lie elsewhere in their pixels.
const TRAINING_SEED: u64 = 0xA;

/// A scene of a plan.
pub(crate) struct Race<'a> {
    pub(crate) plan: &'a BenchPlan,
    pub(crate) target: &'a Target,
    /// Where the files of meshes and rays go.
    pub(crate) folder: &'a Path,
    /// How many scenes are through.
    pub(crate) done: usize,
}

/// A scene that is ready.
struct Track {
    stage: Stage,
    lens: Lens,
    view: String,
}

/// The rays of a column: all of them, and fewer for slow engines.
struct Rays {
    column: Column,
    full: Option<Batch>,
    slow: Option<Batch>,
}

impl Race<'_> {
    /// Races on the first view; what goes wrong is in the document.
    pub(crate) fn run(&self, document: &mut BenchDocument, recorded: &[Record], see: See<'_>) {
        let scene = self.target.entry.id.clone();
        let columns = self.columns(recorded);
        if columns.is_empty() {
            return;
        }
        if let Err(reason) = self.race(&columns, document, see) {
            fail(document, BenchFailure { scene, engine: None, reason }, see);
        }
    }

    /// The columns that aren't recorded yet.
    fn columns(&self, recorded: &[Record]) -> Vec<Column> {
        let (scene, views) = (&self.target.entry.id, self.target.view_names());
        let known = |column: &Column| {
            let same = |r: &Record| r.scene == *scene && r.column == *column;
            // A scene without a listed view has one of its own.
            recorded.iter().any(|r| same(r) && views.first().is_none_or(|view| r.view == *view))
        };
        self.plan.columns.iter().copied().filter(|column| !known(column)).collect()
    }

    fn race(&self, columns: &[Column], document: &mut BenchDocument, see: See<'_>) -> Result<(), String> {
        let track = self.track()?;
        let place = format!("{}:{}", self.target.entry.id, track.view);
        let triangles = track.stage.mesh().len();
        see(&BenchEvent::Scene { place: &place, triangles, done: self.done, total: self.plan.targets.len() });

        let helper = self.helper(&track)?;
        let training = self.training(&track, &helper.accel);
        let ours = self.ours(&track, helper, &training)?;
        for Ours { accel, build_secs } in &ours {
            let (engine, bytes) = (accel.stats().spec.to_string(), accel.stats().bytes as u64);
            see(&BenchEvent::Built { place: &place, engine: &engine, secs: *build_secs, bytes });
        }
        let rays = self.rays(&track, &ours[0].accel, columns)?;
        let mesh = self.folder.join("scene.mesh");
        files::write_mesh(&mesh, track.stage.mesh()).map_err(|e| e.to_string())?;
        self.heats(&track, &ours, &rays, &mesh, document, see);
        Ok(())
    }

    fn track(&self) -> Result<Track, String> {
        let scene = self.target.entry.load(0).map_err(|e| e.to_string())?;
        let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
        let views = self.target.resolve(&scene.views, || stage.overview())?;
        let view = views.first().ok_or("the scene has no view")?;
        let lens = Lens::new(&stage, Mode::Primary, view, 1.0);
        Ok(Track { lens, view: view.name.clone(), stage })
    }

    /// The first structure that needs no rays: it makes them. Answers don't depend on which it is.
    fn helper(&self, track: &Track) -> Result<Ours, String> {
        let spec = self.plan.specs.iter().find(|spec| !spec.needs_rays()).copied().unwrap_or_default();
        build(&track.stage, &spec, &Training::none())
    }

    fn ours(&self, track: &Track, helper: Ours, training: &Training) -> Result<Vec<Ours>, String> {
        let mut helper = Some(helper);
        let one = |spec: &Spec| match helper.take_if(|helper| helper.accel.stats().spec == *spec) {
            Some(helper) => Ok(helper),
            None => build(&track.stage, spec, training),
        };
        self.plan.specs.iter().map(one).collect()
    }

    /// Rays of the same columns from other film positions, with their ends: one profile for all columns.
    fn training(&self, track: &Track, helper: &Accel) -> Training {
        if !self.plan.specs.iter().any(Spec::needs_rays) {
            return Training::none();
        }
        let size = self.plan.training_size;
        let film = Film { size, jitter: true, seed: self.plan.seed ^ TRAINING_SEED };
        let frame = Frame::new(&track.stage, helper, &track.lens, film);
        let recorder = Recorder::new(size * size * self.plan.columns.len(), self.plan.seed);
        for &column in &self.plan.columns {
            for ray in frame.rays(column) {
                recorder.record(&ray, helper.closest(&ray), column.query(), column.class());
            }
        }
        Training::from_samples(recorder.into_profile().samples().to_vec())
    }

    fn rays(&self, track: &Track, accel: &Accel, columns: &[Column]) -> Result<Vec<Rays>, String> {
        let frame =
            |size| Frame::new(&track.stage, accel, &track.lens, Film { size, jitter: false, seed: self.plan.seed });
        let full = frame(self.plan.size);
        let slow = self
            .plan
            .engines
            .iter()
            .any(|e| e.pace == Pace::Slow)
            .then(|| frame(self.plan.slow_size.min(self.plan.size)));
        let rays = |&column: &Column| {
            let slow = slow.as_ref().map(|frame| self.batch(frame, accel, column, "slow")).transpose()?;
            Ok(Rays { column, full: self.batch(&full, accel, column, "full")?, slow: slow.flatten() })
        };
        columns.iter().map(rays).collect()
    }

    /// Nothing if there are no such rays.
    fn batch(&self, frame: &Frame<'_>, accel: &Accel, column: Column, name: &str) -> Result<Option<Batch>, String> {
        let rays = frame.rays(column);
        if rays.is_empty() {
            return Ok(None);
        }
        let file = self.folder.join(format!("{}-{name}.rays", column.name()));
        files::write_rays(&file, &rays).map_err(|e| e.to_string())?;
        let reference = Answers::of(accel, &rays, column.query());
        Ok(Some(Batch { column, rays, file, reference }))
    }

    /// All columns for one group of engines after the other, as memory allows.
    fn heats(
        &self,
        track: &Track,
        ours: &[Ours],
        rays: &[Rays],
        mesh: &Path,
        document: &mut BenchDocument,
        see: See<'_>,
    ) {
        let memory_bytes = self.plan.memory_bytes.unwrap_or_else(memory::usable_bytes);
        let mut groups = groups(&self.plan.engines, track.stage.mesh().len(), memory_bytes);
        if groups.is_empty() {
            // Ours race alone.
            groups.push(Vec::new());
        }
        let mut outcomes: Vec<Vec<Outcome>> = rays.iter().map(|_| Vec::new()).collect();
        let last = groups.len() - 1;
        for (index, keys) in groups.iter().enumerate() {
            let mut processes = self.start(track, keys, mesh, document, see);
            let lanes = self.lanes(ours, &processes);
            let mut running: Vec<Process> = processes.drain(..).map(|(_, process)| process).collect();
            for (rays, outcomes) in rays.iter().zip(&mut outcomes) {
                let mut heat =
                    Heat { lanes: &lanes, processes: &mut running, rounds: self.plan.rounds, trouble: Vec::new() };
                if let Some(batch) = &rays.full {
                    heat.full(batch, outcomes);
                }
                if let Some(batch) = &rays.slow {
                    heat.slow(batch, outcomes);
                }
                for (label, reason) in heat.trouble {
                    let scene = self.target.entry.id.clone();
                    let reason = format!("{}: {reason}", rays.column.name());
                    fail(document, BenchFailure { scene, engine: Some(label), reason }, see);
                }
                if index == last {
                    self.record(track, rays, std::mem::take(outcomes), document, see);
                }
            }
        }
    }

    /// The processes of a group, one started after the other; those that are not there are skipped.
    fn start(
        &self,
        track: &Track,
        keys: &[Key],
        mesh: &Path,
        document: &mut BenchDocument,
        see: See<'_>,
    ) -> Vec<(Key, Process)> {
        let mut processes = Vec::new();
        for (index, key) in keys.iter().enumerate() {
            let label = self.label(key);
            let answers = self.folder.join(format!("{index}.answers"));
            let started = match &self.plan.programs {
                Some(folder) => Process::start(&key.file(folder), &key.mode, mesh, answers),
                None => {
                    Err(Trouble::Absent("no engines are installed; `cargo xtask engines --fetch` gets them".to_owned()))
                }
            };
            match started {
                Ok(process) => {
                    let place = format!("{}:{}", self.target.entry.id, track.view);
                    let (secs, bytes) = (process.built.build_nanos as f64 * 1e-9, process.built.bytes);
                    see(&BenchEvent::Built { place: &place, engine: &label, secs, bytes });
                    processes.push((key.clone(), process));
                }
                Err(Trouble::Absent(reason)) => skip(document, Skipped { engine: label, reason }, see),
                Err(Trouble::Failed(reason)) => {
                    let scene = self.target.entry.id.clone();
                    fail(document, BenchFailure { scene, engine: Some(label), reason }, see);
                }
            }
        }
        processes
    }

    /// By the first competitor that needs it.
    fn label(&self, key: &Key) -> String {
        let engine = self.plan.engines.iter().find(|e| e.program == key.program && e.modes.contains(&key.mode));
        engine.map_or_else(|| key.program.clone(), |engine| engine.label(&key.mode))
    }

    fn lanes<'o>(&self, ours: &'o [Ours], processes: &[(Key, Process)]) -> Vec<Lane<'o>> {
        let mut lanes: Vec<_> = ours.iter().map(Lane::ours).collect();
        for engine in &self.plan.engines {
            for mode in &engine.modes {
                let same = |(key, _): &(Key, Process)| key.program == engine.program && key.mode == *mode;
                if let Some(index) = processes.iter().position(same) {
                    lanes.push(Lane::engine(engine, mode, index, &processes[index].1));
                }
            }
        }
        lanes
    }

    fn record(&self, track: &Track, rays: &Rays, outcomes: Vec<Outcome>, document: &mut BenchDocument, see: See<'_>) {
        let (scene, view) = (self.target.entry.id.clone(), track.view.clone());
        let row =
            |outcome: Outcome| outcome.row(&scene, &view, track.stage.mesh().len(), rays.column, self.plan.tolerance);
        let rows = outcomes.into_iter().map(row).collect();
        let record = Record { scene: scene.clone(), view: view.clone(), column: rays.column, rows };
        see(&BenchEvent::Done(&record));
        document.rows.extend(record.rows);
    }
}

/// A structure and the CPU seconds of its build on one thread.
fn build(stage: &Stage, spec: &Spec, training: &Training) -> Result<Ours, String> {
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let (accel, build_secs) = time_process(|| rdh::build(stage.mesh(), spec, training, &options));
    Ok(Ours { accel: accel.map_err(|e| format!("{spec}: {e}"))?, build_secs })
}

fn fail(document: &mut BenchDocument, failure: BenchFailure, see: See<'_>) {
    see(&BenchEvent::Failed(&failure));
    document.failures.push(failure);
}

/// Said once, not for every scene.
fn skip(document: &mut BenchDocument, skipped: Skipped, see: See<'_>) {
    if !document.skipped.contains(&skipped) {
        see(&BenchEvent::Skipped(&skipped));
        document.skipped.push(skipped);
    }
}
