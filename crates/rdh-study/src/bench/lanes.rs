//! Who races: ours in this process, engines in their own, in groups whose trees fit into memory together.

use std::hint::black_box;
use std::path::{Path, PathBuf};

use rayon::ThreadPool;
use rdh::simd::Level;
use rdh::twin::Twin;
use rdh::{Accel, Hit, Query, Ray, Spec};

use super::columns::Column;
use super::process::{Cast, Process, Trouble};
use super::registry::{Form, Pace, Queries, Registration};
use super::rows::Profile;
use super::verify::{Answers, Difference};
use crate::clock::thread_nanos;

/// Rays of a column, in memory and in a file, and the answers of our first structure.
#[derive(Debug)]
pub(crate) struct Batch {
    pub(crate) column: Column,
    pub(crate) rays: Vec<Ray>,
    pub(crate) file: PathBuf,
    pub(crate) reference: Answers,
}

/// One that casts rays, and what is to be said of it in tables.
#[derive(Debug)]
pub(crate) struct Lane<'a> {
    /// Our spec, or the competitor and its mode.
    pub(crate) label: String,
    /// What ours are compared with; nothing for ours.
    pub(crate) base: Option<String>,
    pub(crate) version: Option<String>,
    pub(crate) form: Form,
    pub(crate) pace: Pace,
    queries: Queries,
    pub(crate) profile: Profile,
    pub(crate) build_secs: f64,
    pub(crate) bytes: u64,
    runner: Runner<'a>,
}

#[derive(Debug, Clone, Copy)]
enum Runner<'a> {
    Ours(&'a Accel),
    Twin(&'a Twin),
    /// All rays at once, on the pool's one thread.
    Batch(&'a Accel, &'a ThreadPool),
    /// Of the group's processes.
    Engine(usize),
}

/// A structure of ours, and the CPU seconds of its build on one thread.
#[derive(Debug)]
pub(crate) struct Ours {
    /// Its name: what was asked for, since an eye's place is another in every scene, or what `auto` chose.
    pub(crate) spec: Spec,
    /// The instructions it is traced with, if they were asked for.
    pub(crate) level: Option<Level>,
    pub(crate) accel: Accel,
    pub(crate) build_secs: f64,
}

impl Ours {
    /// The same structure, traced with other instructions.
    pub(crate) fn at(&self, level: Level) -> Self {
        let accel = self.accel.clone().with_level(level);
        Self { level: Some(level), accel, ..*self }
    }

    /// Its name in tables.
    fn label(&self) -> String {
        match self.level {
            Some(level) => format!("{} on {}", self.spec, level.name()),
            None => self.spec.to_string(),
        }
    }
}

/// A program and what it is asked to build: those that are equal share a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Key {
    pub(crate) program: String,
    pub(crate) mode: String,
}

impl<'a> Lane<'a> {
    /// One of ours.
    pub(crate) fn ours(ours: &'a Ours) -> Self {
        let stats = ours.accel.stats();
        Self {
            label: ours.label(),
            base: None,
            version: None,
            form: Form::Single,
            pace: Pace::Full,
            queries: Queries::Both,
            profile: if stats.spec.needs_rays() { Profile::Guided } else { Profile::None },
            build_secs: ours.build_secs,
            bytes: stats.bytes as u64,
            runner: Runner::Ours(&ours.accel),
        }
    }

    /// One of ours that is handed all rays at once; `pool` has one thread.
    pub(crate) fn batch(ours: &'a Ours, pool: &'a ThreadPool) -> Self {
        let lane = Lane::ours(ours);
        let label = format!("{}({})", Form::Batch.name(), lane.label);
        Self { label, form: Form::Batch, runner: Runner::Batch(&ours.accel, pool), ..lane }
    }

    /// A leaky twin of one of ours.
    pub(crate) fn twin(name: &str, ours: &Ours, twin: &'a Twin) -> Self {
        let Lane { label, form, pace, queries, profile, build_secs, bytes, .. } = Lane::ours(ours);
        let (label, base) = (format!("{name}({label})"), Some(name.to_owned()));
        Self { label, base, version: None, form, pace, queries, profile, build_secs, bytes, runner: Runner::Twin(twin) }
    }

    /// A mode of a competitor, in a process of the group.
    pub(crate) fn engine(engine: &Registration, mode: &str, index: usize, process: &Process) -> Self {
        Self {
            label: engine.label(mode),
            base: Some(engine.name.clone()),
            version: Some(process.built.version.clone()),
            form: engine.form,
            pace: engine.pace,
            queries: engine.queries,
            profile: Profile::None,
            build_secs: process.built.build_nanos as f64 * 1e-9,
            bytes: process.built.bytes,
            runner: Runner::Engine(index),
        }
    }

    /// Whether it takes part: packets are for coherent rays, and some have no any-hit query.
    pub(crate) fn takes(&self, column: Column) -> bool {
        let coherent = self.form != Form::Packets || column.is_coherent();
        coherent && (self.queries == Queries::Both || column.query() == Query::Closest)
    }

    /// How its answers differ, and how many rays hit something.
    pub(crate) fn verify(&self, processes: &mut [Process], batch: &Batch) -> Result<(Difference, u64), Trouble> {
        match self.runner {
            Runner::Ours(accel) => {
                let answers = Answers::of(accel, &batch.rays, batch.column.query());
                Ok((batch.reference.exactly(&answers), answers.hits()))
            }
            Runner::Batch(accel, pool) => {
                let answers = pool.install(|| Answers::of_batch(accel, &batch.rays, batch.column.query()));
                Ok((batch.reference.exactly(&answers), answers.hits()))
            }
            Runner::Twin(twin) => {
                let answers = Answers::given(&batch.rays, batch.column.query(), twin_casts(twin));
                Ok((batch.reference.nearly(&answers.t), answers.hits()))
            }
            Runner::Engine(index) => {
                let answers = processes[index].answers(self.form, batch.column.query(), &batch.file)?;
                if answers.len() != batch.rays.len() {
                    let reason = format!("the engine gave {} answers to {} rays", answers.len(), batch.rays.len());
                    return Err(Trouble::Failed(reason));
                }
                let hits = answers.iter().filter(|t| **t < f32::INFINITY).count() as u64;
                Ok((batch.reference.nearly(&answers), hits))
            }
        }
    }

    /// Casts a batch once.
    pub(crate) fn cast(&self, processes: &mut [Process], batch: &Batch) -> Result<Cast, Trouble> {
        match self.runner {
            Runner::Ours(accel) => Ok(cast_all(&batch.rays, batch.column.query(), accel_casts(accel))),
            Runner::Batch(accel, pool) => Ok(pool.install(|| cast_batch(accel, &batch.rays, batch.column.query()))),
            Runner::Twin(twin) => Ok(cast_all(&batch.rays, batch.column.query(), twin_casts(twin))),
            Runner::Engine(index) => processes[index].cast(self.form, batch.column.query(), &batch.file),
        }
    }
}

impl Key {
    /// The program's file.
    pub(crate) fn file(&self, folder: &Path) -> PathBuf {
        folder.join(format!("{}{}", self.program, std::env::consts::EXE_SUFFIX))
    }
}

/// What has to be built for these competitors, in groups that may be in memory together.
pub(crate) fn groups(engines: &[Registration], triangles: usize, memory_bytes: u64) -> Vec<Vec<Key>> {
    let mut groups: Vec<(u64, Vec<Key>)> = Vec::new();
    for engine in engines {
        for mode in &engine.modes {
            let same = |key: &Key| key.program == engine.program && key.mode == *mode;
            if groups.iter().flat_map(|group| &group.1).any(same) {
                continue;
            }
            let key = Key { program: engine.program.clone(), mode: mode.clone() };
            let bytes = (triangles * engine.bytes_per_triangle) as u64;
            match groups.last_mut() {
                Some((sum, keys)) if *sum + bytes <= memory_bytes => {
                    *sum += bytes;
                    keys.push(key);
                }
                _ => groups.push((bytes, vec![key])),
            }
        }
    }
    groups.into_iter().map(|(_, keys)| keys).collect()
}

/// What casts rays in this process: the nearest hit, and whether there is any.
fn accel_casts(accel: &Accel) -> (impl Fn(&Ray) -> Option<Hit>, impl Fn(&Ray) -> bool) {
    (|ray: &Ray| accel.closest(ray), |ray: &Ray| accel.occluded(ray))
}

fn twin_casts(twin: &Twin) -> (impl Fn(&Ray) -> Option<Hit>, impl Fn(&Ray) -> bool) {
    (|ray: &Ray| twin.closest(ray), |ray: &Ray| twin.occluded(ray))
}

/// The same loop as the engines'.
fn cast_all(
    rays: &[Ray],
    query: Query,
    (closest, occluded): (impl Fn(&Ray) -> Option<Hit>, impl Fn(&Ray) -> bool),
) -> Cast {
    let start = thread_nanos();
    let (mut hits, mut t_sum) = (0, 0.0);
    if query == Query::Occluded {
        hits = rays.iter().filter(|ray| occluded(ray)).count() as u64;
    } else {
        for hit in rays.iter().filter_map(closest) {
            hits += 1;
            t_sum += f64::from(hit.t);
        }
    }
    let (hits, t_sum) = black_box((hits, t_sum));
    Cast { nanos: thread_nanos() - start, hits, t_sum }
}

/// All at once; there is room for the answers already, and they are summed up as the loop does.
fn cast_batch(accel: &Accel, rays: &[Ray], query: Query) -> Cast {
    let (mut closest, mut occluded) = (Vec::new(), Vec::new());
    match query {
        Query::Occluded => occluded.resize(rays.len(), false),
        _ => closest.resize(rays.len(), None),
    }
    let start = thread_nanos();
    let (mut hits, mut t_sum) = (0, 0.0);
    if query == Query::Occluded {
        accel.occluded_many(rays, &mut occluded);
        hits = occluded.iter().filter(|is| **is).count() as u64;
    } else {
        accel.closest_many(rays, &mut closest);
        for hit in closest.iter().flatten() {
            hits += 1;
            t_sum += f64::from(hit.t);
        }
    }
    let (hits, t_sum) = black_box((hits, t_sum));
    Cast { nanos: thread_nanos() - start, hits, t_sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_builds_share_a_process_and_groups_fit_into_memory() {
        let engine = |name: &str, modes: &[&str]| Registration {
            bytes_per_triangle: 10,
            ..Registration::new(name, "program", modes)
        };
        let engines = [engine("a", &["x", "y"]), engine("b", &["y", "z"])];
        let modes = |memory| {
            let groups = groups(&engines, 100, memory);
            groups.iter().map(|g| g.iter().map(|k| k.mode.as_str()).collect::<String>()).collect::<Vec<_>>()
        };
        assert_eq!(modes(3000), ["xyz"]);
        assert_eq!(modes(2999), ["xy", "z"]);
        assert_eq!(modes(0), ["x", "y", "z"]);
    }
}
