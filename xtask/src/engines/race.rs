//! One scene: rays are made, structures built, answers compared, and then rounds timed, interleaved.

use std::path::Path;

use anyhow::{Context, Result};
use rdh::{Accel, BuildOptions, Recorder, Spec, Training};
use rdh_scene::Entry;
use rdh_study::clock::time_process;
use rdh_study::{Lens, Mode, Stage, Target, stats};

use super::columns::{Column, Film, Frame};
use super::contender::{Batch, Cast, Contender, EmbreeSpec, Process};
use super::files;
use super::install::Engine;
use super::report::{Base, Fault, Report, Row};

/// What is to be raced, and how.
pub(crate) struct Plan {
    pub(crate) specs: Vec<Spec>,
    pub(crate) columns: Vec<Column>,
    pub(crate) embree: Option<(Engine, Vec<EmbreeSpec>)>,
    /// Pixels of the film, across and down.
    pub(crate) size: usize,
    pub(crate) rounds: usize,
}

/// Of all rays, how many may hit something for one and nothing for the other: Embree's default leaks at edges.
const TOLERANCE: f64 = 0.001;

/// Pixels of the film of training rays: 16,384 for each column.
const TRAINING_SIZE: usize = 128;
const TRAINING_SEED: u64 = 0xA;

/// Races on the first view of a scene.
pub(crate) fn run(entry: &Entry, plan: &Plan, report: &mut Report) -> Result<()> {
    let scene = entry.load(0)?;
    let stage = Stage::new(&scene)?;
    let target = Target::all(entry.clone());
    let views = target.resolve(&scene.views, || stage.overview()).map_err(anyhow::Error::msg)?;
    let view = views.first().context("the scene has no view")?;
    let lens = Lens::new(&stage, Mode::Primary, view, 1.0);
    eprintln!("{}:{}: {} triangles", entry.id, view.name, stage.mesh().len());

    let folder = tempfile::tempdir()?;
    let helper = build(&stage, &Spec::default(), &Training::none())?.0;
    let frame = Frame::new(&stage, &helper, &lens, Film { size: plan.size, jitter: None });
    let batches = batches(&frame, &plan.columns, folder.path())?;
    let training = training(&stage, &helper, &lens, plan);
    drop((frame, helper));

    let mut contenders = ours(&stage, plan, &training)?;
    contenders.extend(embrees(&stage, plan, folder.path())?);
    for batch in &batches {
        let casts = interleaved(&mut contenders, batch, plan.rounds)?;
        let rows = rows(&contenders, batch, &casts, &entry.id, &view.name);
        report.faults.extend(faults(&rows));
        report.rows.extend(rows);
    }
    Ok(())
}

/// A structure and the CPU seconds of its build on one thread.
fn build(stage: &Stage, spec: &Spec, training: &Training) -> Result<(Accel, f64)> {
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let (accel, secs) = time_process(|| rdh::build(stage.mesh(), spec, training, &options));
    Ok((accel.with_context(|| spec.to_string())?, secs))
}

fn batches(frame: &Frame<'_>, columns: &[Column], folder: &Path) -> Result<Vec<Batch>> {
    let mut batches = Vec::new();
    for &column in columns {
        let rays = frame.rays(column);
        if rays.is_empty() {
            eprintln!(
                "  {}: skipped: there are no such rays, since no primary ray hits a fitting surface",
                column.name()
            );
            continue;
        }
        let file = folder.join(format!("{}.cast", column.name()));
        files::write_rays(&file, &rays)?;
        batches.push(Batch { column, rays, file });
    }
    Ok(batches)
}

/// Rays of the same columns from other film positions, with their ends: one profile for all columns.
fn training(stage: &Stage, helper: &Accel, lens: &Lens, plan: &Plan) -> Training {
    if !plan.specs.iter().any(Spec::needs_rays) {
        return Training::none();
    }
    let frame = Frame::new(stage, helper, lens, Film { size: TRAINING_SIZE, jitter: Some(TRAINING_SEED) });
    let recorder = Recorder::new(TRAINING_SIZE * TRAINING_SIZE * plan.columns.len(), TRAINING_SEED);
    for &column in &plan.columns {
        for ray in frame.rays(column) {
            recorder.record(&ray, helper.closest(&ray), column.query(), column.class());
        }
    }
    Training::from_samples(recorder.into_profile().samples().to_vec())
}

fn ours(stage: &Stage, plan: &Plan, training: &Training) -> Result<Vec<Contender>> {
    let build = |spec: &Spec| {
        let (accel, build_secs) = build(stage, spec, training)?;
        let trained = spec.needs_rays();
        Ok(Contender::Ours { name: spec.to_string(), accel: Box::new(accel), build_secs, trained })
    };
    plan.specs.iter().map(build).collect()
}

fn embrees(stage: &Stage, plan: &Plan, folder: &Path) -> Result<Vec<Contender>> {
    let Some((engine, specs)) = &plan.embree else { return Ok(Vec::new()) };
    let file = folder.join("scene.mesh");
    files::write_mesh(&file, stage.mesh())?;
    let mut contenders = Vec::new();
    for spec in specs {
        if spec.is_supported() {
            let process = Process::start(engine, spec, &file).with_context(|| format!("embree4({spec})"))?;
            contenders.push(Contender::Embree { spec: spec.clone(), process });
        } else {
            eprintln!("  embree4({spec}): skipped: this machine lacks its instructions");
        }
    }
    Ok(contenders)
}

/// The casts of each contender, `[contender][round]`. In each round all cast in turn, and each round begins with another one;
/// before the first, each casts once to get warm.
fn interleaved(contenders: &mut [Contender], batch: &Batch, rounds: usize) -> Result<Vec<Vec<Cast>>> {
    let mut casts = vec![Vec::with_capacity(rounds); contenders.len()];
    for contender in contenders.iter_mut() {
        contender.cast(batch).with_context(|| contender.name())?;
    }
    for round in 0..rounds {
        for turn in 0..contenders.len() {
            let which = (round + turn) % contenders.len();
            casts[which].push(contenders[which].cast(batch)?);
        }
    }
    Ok(casts)
}

fn rows(contenders: &[Contender], batch: &Batch, casts: &[Vec<Cast>], scene: &str, view: &str) -> Vec<Row> {
    let rate = |nanos: f64| batch.rays.len() as f64 * 1e3 / nanos;
    let row = |(contender, casts): (&Contender, &Vec<Cast>)| {
        let nanos: Vec<f64> = casts.iter().map(|c| c.nanos.max(1) as f64).collect();
        let (base, trained) = match contender {
            Contender::Ours { trained, .. } => (None, *trained),
            Contender::Embree { spec, .. } => {
                (Some(if spec.robust { Base::Embree4Robust } else { Base::Embree4 }), false)
            }
        };
        Row {
            scene: scene.to_owned(),
            view: view.to_owned(),
            column: batch.column,
            engine: contender.name(),
            base,
            trained,
            rays: batch.rays.len(),
            hits: casts[0].hits,
            t_sum: casts[0].t_sum,
            mrays_per_sec: rate(stats::median(&nanos)),
            mrays_per_sec_best: rate(nanos.iter().copied().fold(f64::INFINITY, f64::min)),
            build_secs: contender.build_secs(),
            bytes: contender.bytes(),
        }
    };
    contenders.iter().zip(casts).map(row).collect()
}

/// Where answers differ from the first row's, which is ours: not at all among ours, little for others.
fn faults(rows: &[Row]) -> Vec<Fault> {
    let first = &rows[0];
    let mut faults = Vec::new();
    for row in &rows[1..] {
        let hits_differ = row.hits.abs_diff(first.hits) as f64 / row.rays as f64;
        let t_differs = (row.t_sum - first.t_sum).abs() / first.t_sum.abs().max(f64::MIN_POSITIVE);
        let allowed = if row.base.is_some() { TOLERANCE } else { 0.0 };
        let place = format!("{}:{} {}: {}", row.scene, row.view, row.column.name(), row.engine);
        if hits_differ > allowed {
            faults.push(Fault(format!(
                "{place} hits {} of {} rays, {} {}",
                row.hits, row.rays, first.engine, first.hits
            )));
        } else if t_differs > allowed && first.t_sum != 0.0 {
            faults.push(Fault(format!("{place}: sum of distances {}, {} {}", row.t_sum, first.engine, first.t_sum)));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(base: Option<Base>, hits: u64, t_sum: f64) -> Row {
        Row {
            scene: "s".to_owned(),
            view: "v".to_owned(),
            column: Column::Rows,
            engine: "e".to_owned(),
            base,
            trained: false,
            rays: 10_000,
            hits,
            t_sum,
            mrays_per_sec: 1.0,
            mrays_per_sec_best: 1.0,
            build_secs: 0.0,
            bytes: 0,
        }
    }

    #[test]
    fn ours_must_agree_exactly_and_others_nearly() {
        let count = |other: Row| faults(&[row(None, 5000, 100.0), other]).len();
        assert_eq!(count(row(None, 5000, 100.0)), 0);
        assert_eq!(count(row(None, 5001, 100.0)), 1);
        assert_eq!(count(row(None, 5000, 100.0 + 1e-9)), 1);
        assert_eq!(count(row(Some(Base::Embree4), 5010, 100.05)), 0);
        assert_eq!(count(row(Some(Base::Embree4), 4989, 100.0)), 1);
        assert_eq!(count(row(Some(Base::Embree4Robust), 5000, 100.2)), 1);
    }
}
