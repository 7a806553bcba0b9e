//! A scene, loaded and ready, with one view of it.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context as _, Result};
use rdh::{Accel, BuildOptions, Spec, Training, build};
use rdh_scene::View;
use rdh_scene::saved::Setting;
use rdh_study::{Mode, Plan, Shoot, Stage, Target};

use crate::exit::usage;

/// A scene made ready for integrators, and who looks at it.
#[derive(Debug)]
pub(crate) struct Staged {
    pub scene: String,
    /// The frame of its animation; 0 at rest.
    pub frame: u32,
    pub view: View,
    pub stage: Arc<Stage>,
    /// How the scene lies and is looked at, to be saved with a tree.
    pub setting: Arc<Setting>,
}

impl Staged {
    /// Loads a scene at the target's first frame and finds the view: the target's, else its first one, else one from outside.
    ///
    /// # Errors
    /// What the reader says; usage for an unknown view.
    pub(crate) fn load(target: &Target) -> Result<Self> {
        Self::load_all(target)?.into_iter().next().context("the scene has no view")
    }

    /// Loads a scene once, with all the target's views.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub(crate) fn load_all(target: &Target) -> Result<Vec<Self>> {
        let frame = target.frames.first().copied().unwrap_or_default();
        let scene = target.entry.load(frame).with_context(|| format!("scene '{}'", target.entry.id))?;
        for note in &scene.notes {
            tracing::warn!("{}: {} {}", target.entry.id, note.count, note.what);
        }
        let stage = Arc::new(Stage::new(&scene).with_context(|| format!("scene '{}'", target.entry.id))?);
        let views = target.resolve(&scene.views, || stage.overview()).map_err(usage)?;
        let setting = Arc::new(Setting { id: target.entry.id.clone(), ..Setting::of(&scene) });
        let with = |view: View| Self {
            scene: target.entry.id.clone(),
            frame,
            view,
            stage: Arc::clone(&stage),
            setting: Arc::clone(&setting),
        };
        Ok(views.into_iter().map(with).collect())
    }

    /// `scene:view` or `scene:view@frame`, as it is typed.
    pub(crate) fn name(&self) -> String {
        let frame = if self.frame > 0 { format!("@{}", self.frame) } else { String::new() };
        format!("{}:{}{frame}", self.scene, self.view.name)
    }

    /// Builds a structure on this thread; its log says what was built, and how long it took.
    pub(crate) fn build(&self, spec: &Spec, rays: &Training) -> Result<Accel> {
        let start = Instant::now();
        let accel = build(self.stage.mesh(), spec, rays, &BuildOptions::default())
            .with_context(|| format!("{} can't be built by {spec}", self.scene))?;
        let (stats, secs) = (accel.stats(), start.elapsed().as_secs_f64());
        tracing::info!("{spec}: {} nodes, {} references, {secs:.2} s", stats.nodes, stats.references);
        Ok(accel)
    }

    /// What makes the rays of a mode at this view.
    pub(crate) fn shoot(&self, mode: Mode, plan: &Plan) -> Shoot<'_> {
        Shoot::new(&self.stage, mode, &self.view, plan)
    }
}
