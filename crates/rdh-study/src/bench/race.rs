//! One scene: our structures and the engines, group by group as memory allows, on all columns.

use std::path::Path;

use rayon::ThreadPool;
use rdh::StructureSpec;
use rdh::bvh::Width;
use rdh::twin::Twin;

use super::BenchEvent;
use super::columns::Column;
use super::heat::{Heat, Outcome};
use super::lanes::{Key, Lane, Ours, groups};
use super::memory;
use super::plan::BenchPlan;
use super::process::{Process, Trouble};
use super::registry::Registration;
use super::rows::{BenchDocument, BenchFailure, Record, Skipped};
use super::track::{Rays, Track};
use crate::plan::Target;

/// A scene of a plan.
pub(crate) struct Race<'a, 's> {
    pub(crate) plan: &'a BenchPlan,
    pub(crate) target: &'a Target,
    /// Where the files of meshes and rays go.
    pub(crate) folder: &'a Path,
    /// How many scenes are through.
    pub(crate) done: usize,
    /// Where what is found out goes.
    pub(crate) document: &'a mut BenchDocument,
    pub(crate) see: &'a mut (dyn FnMut(&BenchEvent<'_>) + 's),
    /// What has come up since the last record.
    pub(crate) failures: Vec<BenchFailure>,
    pub(crate) skipped: Vec<Skipped>,
}

/// A leaky twin and its original.
struct Pair<'o> {
    name: &'static str,
    original: &'o Ours,
    twin: Twin,
}

impl Race<'_, '_> {
    /// Races on the first view, all columns that aren't recorded yet; what goes wrong is in the document.
    pub(crate) fn run(&mut self, recorded: &[Record]) {
        let columns = self.columns(recorded);
        if columns.is_empty() {
            return;
        }
        if let Err(reason) = self.race(&columns) {
            self.fail(None, reason);
        }
    }

    fn columns(&self, recorded: &[Record]) -> Vec<Column> {
        let (scene, views) = (&self.target.entry.id, self.target.view_names());
        let known = |column: &Column| {
            let same = |r: &Record| r.scene == *scene && r.column == *column;
            // A scene without a listed view has one of its own.
            recorded.iter().any(|r| same(r) && views.first().is_none_or(|view| r.view == *view))
        };
        self.plan.columns.iter().copied().filter(|column| !known(column)).collect()
    }

    fn race(&mut self, columns: &[Column]) -> Result<(), String> {
        let track = Track::new(self.target, self.folder)?;
        let place = format!("{}:{}", self.target.entry.id, track.view);
        let triangles = track.stage.mesh().len();
        let (done, total) = (self.done, self.plan.targets.len());
        (self.see)(&BenchEvent::Scene { place: &place, triangles, done, total });
        let ours = track.ours(self.plan)?;
        for Ours { spec, accel, build_secs, .. } in &ours {
            self.built(&track, &spec.to_string(), *build_secs, accel.stats().bytes as u64);
        }
        let rays = track.rays(&ours[0].accel, self.plan, columns, self.folder)?;
        let ours = self.at_levels(ours);
        let twins = self.twins(&ours);
        self.heats(&track, (&ours, &twins), &rays);
        Ok(())
    }

    /// Each of ours with the instructions that were asked for.
    fn at_levels(&self, ours: Vec<Ours>) -> Vec<Ours> {
        match self.plan.levels.as_slice() {
            [] => ours,
            levels => ours.iter().flat_map(|ours| levels.iter().map(|level| ours.at(*level))).collect(),
        }
    }

    /// The leaky twins that race, and whose they are.
    fn twins<'o>(&mut self, ours: &'o [Ours]) -> Vec<Pair<'o>> {
        let Some(spec) = self.plan.twin else { return Vec::new() };
        let Some(original) = ours.iter().find(|ours| ours.spec == spec) else { return Vec::new() };
        let mut pairs = Vec::new();
        for (name, leak) in BenchPlan::TWINS {
            match Twin::of(&original.accel, leak) {
                Some(twin) => pairs.push(Pair { name, original, twin }),
                None => {
                    let reason = "a twin needs a bvh8 of ordinary size, and AVX2".to_owned();
                    self.skip(Skipped { engine: name.to_owned(), reason });
                }
            }
        }
        pairs
    }

    /// All columns for one group of engines after the other.
    fn heats(&mut self, track: &Track, ours: (&[Ours], &[Pair<'_>]), rays: &[Rays]) {
        let field = self.field(track);
        let memory_bytes = self.plan.memory_bytes.unwrap_or_else(memory::usable_bytes);
        let mut groups = groups(&field, track.stage.mesh().len(), memory_bytes);
        if groups.is_empty() {
            // Ours race alone.
            groups.push(Vec::new());
        }
        let mut outcomes: Vec<Vec<Outcome>> = rays.iter().map(|_| Vec::new()).collect();
        let last = groups.len() - 1;
        let pool = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
            Ok(pool) => Some(pool),
            Err(error) => {
                self.fail(None, format!("batches: {error}"));
                None
            }
        };
        for (index, keys) in groups.iter().enumerate() {
            let (keys, mut processes): (Vec<_>, Vec<_>) = self.start(track, keys).into_iter().unzip();
            let lanes = lanes(ours, pool.as_ref(), &field, keys, &processes);
            for (rays, outcomes) in rays.iter().zip(&mut outcomes) {
                self.heat(rays, &lanes, &mut processes, outcomes);
                if index == last {
                    self.record(track, rays.column, std::mem::take(outcomes));
                }
            }
        }
    }

    /// The competitors that take part in a scene of this size.
    fn field(&mut self, track: &Track) -> Vec<Registration> {
        let triangles = track.stage.mesh().len();
        let (field, absent): (Vec<_>, Vec<_>) =
            self.plan.engines.iter().cloned().partition(|engine| triangles <= engine.most_triangles);
        for engine in absent {
            let reason = format!("{}: more than {} triangles", self.target.entry.id, engine.most_triangles);
            self.skip(Skipped { engine: engine.name, reason });
        }
        field
    }

    fn heat(&mut self, rays: &Rays, lanes: &[Lane<'_>], processes: &mut [Process], outcomes: &mut Vec<Outcome>) {
        let mut heat = Heat { lanes, processes, rounds: self.plan.rounds, trouble: Vec::new() };
        if let Some(batch) = &rays.full {
            heat.full(batch, outcomes);
        }
        if let Some(batch) = &rays.slow {
            heat.slow(batch, outcomes);
        }
        for (label, reason) in heat.trouble {
            self.fail(Some(label), format!("{}: {reason}", rays.column.name()));
        }
    }

    /// The processes of a group, one started after the other; those that are not there are skipped.
    fn start(&mut self, track: &Track, keys: &[Key]) -> Vec<(Key, Process)> {
        let mut processes = Vec::new();
        for (index, key) in keys.iter().enumerate() {
            let label = self.label(key);
            let answers = self.folder.join(format!("{index}.answers"));
            let started = match &self.plan.programs {
                Some(folder) => Process::start(&key.file(folder), &key.mode, &track.mesh, answers, None),
                None => {
                    Err(Trouble::Absent("no engines are installed; `cargo xtask engines --fetch` gets them".into()))
                }
            };
            match started {
                Ok(process) => {
                    self.built(track, &label, process.built.build_nanos as f64 * 1e-9, process.built.bytes);
                    processes.push((key.clone(), process));
                }
                Err(Trouble::Absent(reason)) => self.skip_all(key, &reason),
                Err(Trouble::Failed(reason)) => self.fail(Some(label), reason),
            }
        }
        processes
    }

    /// All competitors that need it, by name.
    fn skip_all(&mut self, key: &Key, reason: &str) {
        for engine in self.plan.engines.iter().filter(|e| e.program == key.program && e.modes.contains(&key.mode)) {
            self.skip(Skipped { engine: engine.name.clone(), reason: reason.to_owned() });
        }
    }

    /// By the first competitor that needs it.
    fn label(&self, key: &Key) -> String {
        let engine = self.plan.engines.iter().find(|e| e.program == key.program && e.modes.contains(&key.mode));
        engine.map_or_else(|| key.program.clone(), |engine| engine.label(&key.mode))
    }

    fn record(&mut self, track: &Track, column: Column, mut outcomes: Vec<Outcome>) {
        // In the plan's order, ours first, whatever group they ran in.
        outcomes.sort_by_key(|outcome| self.plan.engines.iter().position(|e| Some(&e.name) == outcome.base.as_ref()));
        let (scene, view) = (self.target.entry.id.clone(), track.view.clone());
        let (failures, skipped) = (std::mem::take(&mut self.failures), std::mem::take(&mut self.skipped));
        let row = |outcome: Outcome| outcome.row(&scene, &view, track.stage.mesh().len(), column, self.plan.tolerance);
        let rows = outcomes.into_iter().map(row).collect();
        let record = Record { scene: scene.clone(), view: view.clone(), column, rows, failures, skipped };
        (self.see)(&BenchEvent::Done(&record));
        self.document.rows.extend(record.rows);
    }

    fn built(&mut self, track: &Track, engine: &str, secs: f64, bytes: u64) {
        let place = format!("{}:{}", self.target.entry.id, track.view);
        (self.see)(&BenchEvent::Built { place: &place, engine, secs, bytes });
    }

    fn fail(&mut self, engine: Option<String>, reason: String) {
        let failure = BenchFailure { scene: self.target.entry.id.clone(), engine, reason };
        (self.see)(&BenchEvent::Failed(&failure));
        self.document.fail(&failure);
        self.failures.push(failure);
    }

    /// Said once, not for every scene.
    fn skip(&mut self, skipped: Skipped) {
        if !self.document.skipped.contains(&skipped) {
            (self.see)(&BenchEvent::Skipped(&skipped));
            self.document.skip(&skipped);
            self.skipped.push(skipped);
        }
    }
}

/// Ours, and what the processes of a group make of the competitors.
fn lanes<'o>(
    (ours, twins): (&'o [Ours], &'o [Pair<'o>]),
    pool: Option<&'o ThreadPool>,
    field: &[Registration],
    keys: Vec<Key>,
    processes: &[Process],
) -> Vec<Lane<'o>> {
    let mut lanes: Vec<_> = ours.iter().map(Lane::ours).collect();
    // Others cast their batches ray by ray.
    let has_tiles = |ours: &&Ours| match ours.accel.stats().spec.structure {
        StructureSpec::Bvh(bvh) => bvh.width == Width::Eight,
        StructureSpec::Kd(_) | StructureSpec::Eye(_) => true,
        _ => false,
    };
    lanes.extend(pool.iter().flat_map(|pool| ours.iter().filter(has_tiles).map(|ours| Lane::batch(ours, pool))));
    lanes.extend(twins.iter().map(|pair| Lane::twin(pair.name, pair.original, &pair.twin)));
    for engine in field {
        for mode in &engine.modes {
            let same = |key: &Key| key.program == engine.program && key.mode == *mode;
            if let Some(index) = keys.iter().position(same) {
                lanes.push(Lane::engine(engine, mode, index, &processes[index]));
            }
        }
    }
    lanes
}
