//! The same bits everywhere: trees on any number of threads and by any instructions, and what every structure answers at every level,
//! down to brute force.

use std::io;

use rdh::simd::Level;
use rdh::{Accel, BuildOptions, Hit, Provenance, Query, Ray, Recorder, Spec, Training, naive};
use rdh_scene::Entry;

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

use crate::bench::{Column, Film, Frame};
use crate::integrate::{Lens, Mode, Stage};

/// One of each kind of tree.
pub const FAMILIES: &str = "kd+sah,kd(split=exact)+sah,kd(leaf=1,split=exact)+sah,kd+rdh,kd+rdh(paper),bvh2+sah,bvh4+sah,bvh8+sah,\
                            bvh8(quick)+sah,bvh8(high)+sah,bvh8(split=sweep)+sah,sbvh4(split=sweep)+sah,sbvh8+sah,\
                            bvh8(from=kd)+sah,bvh4(high,from=kd)+rdh,bvh8(compact)+sah,sbvh8(quick,compact)+sah,bvh8+rdh,\
                            bvh2+rdh(prior=0),bvh8(high)+rdh,sbvh8(high)+rdh(rays=whole),auto";

/// Of scenes that take minutes a tree.
pub const LARGE_FAMILIES: &str = "kd+sah,bvh8+rdh,sbvh8+sah,bvh8(from=kd)+sah,bvh8(compact)+sah";

/// What is compared on a scene.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// What is built.
    pub specs: Vec<Spec>,
    /// Numbers of threads that build, each by other instructions; with the first tree the others are compared.
    pub threads: Vec<usize>,
    /// Pixels across and down of the film, whose primary rays all others follow from.
    pub size: usize,
    /// How many pairs of a ray and a triangle brute force may look at in each column. It gets two rays whatever stands here.
    pub pairs: usize,
}

/// What was compared on a scene, and what was not the same.
#[derive(Debug, Default)]
pub struct Compared {
    /// Trees that were built.
    pub trees: usize,
    /// Rays of all columns.
    pub rays: usize,
    /// How many of them brute force answered.
    pub by_brute_force: usize,
    /// Answers that were compared.
    pub answers: usize,
    /// What was not the same, one line each; of each kind the first alone.
    pub faults: Vec<String>,
}

/// Compares everything on the first view of a scene.
///
/// # Errors
/// A scene that can't be read, or a tree that can't be built.
pub fn compare(entry: &Entry, wanted: &Comparison) -> Result<Compared, String> {
    let scene = entry.load(0).map_err(|e| e.to_string())?;
    let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
    let view = scene.views.first().cloned().unwrap_or_else(|| stage.overview());
    let lens = Lens::new(&stage, Mode::Primary, &view, 1.0);
    let mut work = Work { stage: &stage, wanted, compared: Compared::default() };
    let first = work.build(&Spec::default(), &Training::none(), 1, Level::PORTABLE)?;
    let frame = |seed, jitter| Frame::new(&stage, &first, &lens, Film { size: wanted.size, jitter, seed });
    let training = training(&frame(2, true), &first);
    let batches: Vec<Batch> = Column::ALL.map(|column| work.batch(column, &frame(1, false), &first)).into();
    drop(first);
    for spec in &wanted.specs {
        let mut tree = work.trees(spec, &training)?;
        for level in Level::available() {
            tree = tree.with_level(level);
            batches.iter().for_each(|batch| work.cast(&format!("{spec}, {}", level.name()), &tree, batch));
        }
    }
    Ok(work.compared)
}

/// The SHA-256 of a structure as it is saved, in hexadecimal digits: of all its arrays, its mesh, and what was asked for, without notes of
/// how it came about. One that is never saved has its own short hash instead.
pub fn digest(accel: &Accel) -> String {
    let bare = accel.clone().with_provenance(Provenance::default());
    let mut hash = Hashed(Sha256::new());
    match bare.write_to(&mut hash) {
        Ok(()) => HEXLOWER.encode(&hash.0.finalize()),
        Err(_) => format!("{:016x}", accel.fingerprint()),
    }
}

/// What is written into it is hashed.
struct Hashed(Sha256);

impl io::Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The rays of a column, and what they hit.
struct Batch {
    column: Column,
    rays: Vec<Ray>,
    answers: Vec<Answer>,
}

/// All bits of an answer: `t`, `u`, `v` and the triangle; zeros for an occlusion.
type Answer = Option<[u32; 4]>;

fn answer(accel: &Accel, query: Query, ray: &Ray) -> Answer {
    match query {
        Query::Occluded => accel.occluded(ray).then_some([0; 4]),
        _ => accel.closest(ray).map(bits),
    }
}

fn bits(hit: Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.tri.0]
}

/// Other rays of all columns, with their ends.
fn training(frame: &Frame<'_>, accel: &Accel) -> Training {
    let rays: Vec<_> = Column::ALL.into_iter().map(|column| (column, frame.rays(column))).collect();
    let recorder = Recorder::new(rays.iter().map(|(_, rays)| rays.len()).sum::<usize>().max(1), 1);
    for (column, rays) in &rays {
        rays.iter().for_each(|ray| recorder.record(ray, accel.closest(ray), column.query(), column.class()));
    }
    Training::from_samples(recorder.into_profile().samples().to_vec())
}

/// A scene at work.
struct Work<'a> {
    stage: &'a Stage,
    wanted: &'a Comparison,
    compared: Compared,
}

impl Work<'_> {
    fn build(&mut self, spec: &Spec, rays: &Training, threads: usize, level: Level) -> Result<Accel, String> {
        let options = BuildOptions { threads: Some(threads), level: Some(level), ..BuildOptions::default() };
        self.compared.trees += 1;
        rdh::build(self.stage.mesh(), spec, rays, &options).map_err(|e| format!("{spec}: {e}"))
    }

    /// A column's rays and a structure's answers, of which brute force looks at some.
    fn batch(&mut self, column: Column, frame: &Frame<'_>, accel: &Accel) -> Batch {
        let rays = frame.rays(column);
        let answers: Vec<_> = rays.iter().map(|ray| answer(accel, column.query(), ray)).collect();
        let mesh = self.stage.mesh();
        let sample = (self.wanted.pairs / mesh.len().max(1)).clamp(2, rays.len().max(2));
        for i in (0..rays.len()).step_by(rays.len().div_ceil(sample).max(1)) {
            let truth = match column.query() {
                Query::Occluded => naive::occluded(mesh, &rays[i]).then_some([0; 4]),
                _ => naive::closest(mesh, &rays[i]).map(bits),
            };
            self.compared.by_brute_force += 1;
            if truth != answers[i] {
                let (name, ray, answer) = (column.name(), rays[i], answers[i]);
                self.fault(
                    &format!("{name}: brute force"),
                    format!("finds {truth:?}, the first tree {answer:?}, of {ray:?}"),
                );
            }
        }
        self.compared.rays += rays.len();
        Batch { column, rays, answers }
    }

    /// The tree of a spec. Each number of threads builds by other instructions, the first by the best.
    fn trees(&mut self, spec: &Spec, training: &Training) -> Result<Accel, String> {
        let levels = Level::available();
        let ways: Vec<_> = self.wanted.threads.iter().copied().zip(levels.into_iter().rev().cycle()).collect();
        let (&(threads, level), others) = ways.split_first().ok_or("no number of threads is given")?;
        let tree = self.build(spec, training, threads, level)?;
        let known = digest(&tree);
        for &(threads, level) in others {
            if digest(&self.build(spec, training, threads, level)?) != known {
                self.fault(&spec.to_string(), format!("{threads} threads with {} build another tree", level.name()));
            }
        }
        Ok(tree)
    }

    fn cast(&mut self, who: &str, tree: &Accel, batch: &Batch) {
        self.compared.answers += batch.rays.len();
        for (ray, known) in batch.rays.iter().zip(&batch.answers) {
            let answer = answer(tree, batch.column.query(), ray);
            if answer != *known {
                let who = format!("{who}, {}", batch.column.name());
                return self.fault(&who, format!("{answer:?} instead of {known:?} for {ray:?}"));
            }
        }
    }

    fn fault(&mut self, who: &str, what: String) {
        self.compared.faults.push(format!("{who}: {what}"));
    }
}
