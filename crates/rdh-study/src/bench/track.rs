//! What a scene is raced on: its rays, and our structures.

use std::path::{Path, PathBuf};

use rdh::{Accel, BuildOptions, Recorder, Spec, Training};

use super::columns::{Column, Film, Frame};
use super::files;
use super::lanes::{Batch, Ours};
use super::plan::BenchPlan;
use super::registry::Pace;
use super::verify::Answers;
use crate::clock::time_process;
use crate::integrate::{Lens, Mode, Stage};
use crate::plan::Target;

/// A scene that is ready.
pub(crate) struct Track {
    pub(crate) stage: Stage,
    lens: Lens,
    /// The view's name.
    pub(crate) view: String,
    /// The file of its triangles.
    pub(crate) mesh: PathBuf,
}

/// The rays of a column: all of them, and fewer for slow engines; nothing where there are none.
pub(crate) struct Rays {
    pub(crate) column: Column,
    pub(crate) full: Option<Batch>,
    pub(crate) slow: Option<Batch>,
}

/// Training rays lie elsewhere in their pixels.
const TRAINING_SEED: u64 = 0xA;

impl Track {
    /// Loads a scene, for the first of its wanted views.
    pub(crate) fn new(target: &Target, folder: &Path) -> Result<Self, String> {
        let scene = target.entry.load(0).map_err(|e| e.to_string())?;
        let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
        let views = target.resolve(&scene.views, || stage.overview())?;
        let view = views.first().ok_or("the scene has no view")?;
        let lens = Lens::new(&stage, Mode::Primary, view, 1.0);
        let mesh = folder.join("scene.mesh");
        files::write_mesh(&mesh, stage.mesh()).map_err(|e| e.to_string())?;
        Ok(Self { lens, view: view.name.clone(), stage, mesh })
    }

    /// Our structures, in the plan's order.
    pub(crate) fn ours(&self, plan: &BenchPlan) -> Result<Vec<Ours>, String> {
        // The first that needs no rays makes them. Answers don't depend on which it is.
        let plain = plan.specs.iter().find(|spec| !spec.needs_rays()).copied().unwrap_or_default();
        let helper = build(&self.stage, &plain, &Training::none())?;
        let training = self.training(&helper.accel, plan);
        let mut helper = Some(helper);
        let one = |spec: &Spec| match helper.take_if(|helper| helper.spec == *spec) {
            Some(helper) => Ok(helper),
            None => build(&self.stage, spec, &training),
        };
        plan.specs.iter().map(one).collect()
    }

    /// Rays of the same columns from other film positions, with their ends: one profile for all columns.
    fn training(&self, helper: &Accel, plan: &BenchPlan) -> Training {
        if !plan.specs.iter().any(Spec::needs_rays) {
            return Training::none();
        }
        let size = plan.training_size;
        let film = Film { size, jitter: true, seed: plan.seed ^ TRAINING_SEED };
        let frame = Frame::new(&self.stage, helper, &self.lens, film);
        let recorder = Recorder::new(size * size * plan.columns.len(), plan.seed);
        for &column in &plan.columns {
            for ray in frame.rays(column) {
                recorder.record(&ray, helper.closest(&ray), column.query(), column.class());
            }
        }
        Training::from_samples(recorder.into_profile().samples().to_vec())
    }

    /// The rays of each column, with the answers of one of ours, in files of a folder.
    pub(crate) fn rays(
        &self,
        accel: &Accel,
        plan: &BenchPlan,
        columns: &[Column],
        folder: &Path,
    ) -> Result<Vec<Rays>, String> {
        let frame = |size| Frame::new(&self.stage, accel, &self.lens, Film { size, jitter: false, seed: plan.seed });
        let full = frame(plan.size);
        let has_slow = plan.engines.iter().any(|engine| engine.pace == Pace::Slow);
        let slow = has_slow.then(|| frame(plan.slow_size.min(plan.size)));
        let rays = |&column: &Column| {
            let slow = slow.as_ref().map(|frame| batch(frame, accel, column, folder, "slow")).transpose()?;
            Ok(Rays { column, full: batch(&full, accel, column, folder, "full")?, slow: slow.flatten() })
        };
        columns.iter().map(rays).collect()
    }
}

/// Nothing if there are no such rays.
fn batch(frame: &Frame<'_>, accel: &Accel, column: Column, folder: &Path, name: &str) -> Result<Option<Batch>, String> {
    let rays = frame.rays(column);
    if rays.is_empty() {
        return Ok(None);
    }
    let file = folder.join(format!("{}-{name}.rays", column.name()));
    files::write_rays(&file, &rays).map_err(|e| e.to_string())?;
    let reference = Answers::of(accel, &rays, column.query());
    Ok(Some(Batch { column, rays, file, reference }))
}

/// A structure and the CPU seconds of its build on one thread.
fn build(stage: &Stage, spec: &Spec, training: &Training) -> Result<Ours, String> {
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let (accel, build_secs) = time_process(|| rdh::build(stage.mesh(), spec, training, &options));
    let accel = accel.map_err(|e| format!("{spec}: {e}"))?;
    // What was chosen is what races.
    let spec = if *spec == Spec::AUTO { accel.stats().spec } else { *spec };
    Ok(Ours { spec, level: None, accel, build_secs })
}
