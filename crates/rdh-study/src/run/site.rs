//! A scene at a frame, where training rays can be cast from any of its views.

use rdh::{Accel, BuildOptions, Mesh, Profile, Spec, Training};
use rdh_scene::{Entry, View};

use super::Load;
use super::build::Lesson;
use crate::clock::time_process;
use crate::integrate::{Mode, Shoot, Stage};
use crate::plan::{Plan, Protocol, Source, find_view, path_view};

/// A scene at a frame, where training rays can be cast from any of its views.
pub struct Site<'a> {
    /// The scene.
    pub entry: &'a Entry,
    /// The frame.
    pub frame: u32,
    /// The scene, ready for integrators.
    pub stage: &'a Stage,
    /// The tree that rays are cast through.
    pub first: &'a Accel,
    /// All its views.
    pub views: &'a [View],
    /// Film, training and seed.
    pub plan: &'a Plan,
    /// Where other frames come from.
    pub load: &'a Load,
}

/// The tree that is built in a hurry, to cast a part of the frame through.
const HURRY: &str = "bvh8(quick)+sah";

impl Site<'_> {
    /// Training rays for a view in a mode; a view of a camera path is named `path@frame`.
    ///
    /// # Errors
    /// A view or a frame that there isn't, in words.
    pub fn lesson(&self, source: &Source, view: &View, mode: Mode) -> Result<Lesson, String> {
        match source {
            Source::None => Ok(Lesson::none()),
            Source::Frame(part) => self.this_frame(view, mode, *part),
            Source::Previous(frames) => self.previous(view, mode, *frames),
            Source::View(name) => Ok(self.looking_from(find_view(self.views, name)?, mode, self.plan.training)),
            Source::All => Ok(self.all_views(mode)),
        }
    }

    fn looking_from(&self, view: &View, mode: Mode, count: usize) -> Lesson {
        let plan = Plan { protocol: Protocol::Unseen, training: count, ..self.plan.clone() };
        Lesson::cast(&Shoot::new(self.stage, mode, view, &plan), self.first, 0, (view, self.frame))
    }

    /// One in `part` pixels, through a tree that is built in a hurry; both are paid for.
    fn this_frame(&self, view: &View, mode: Mode, part: u32) -> Result<Lesson, String> {
        let [columns, rows] = mode.film(self.plan.size);
        let count = (columns * rows / part.max(1) as usize).max(1);
        let plan = Plan { protocol: Protocol::Paper, training: count, ..self.plan.clone() };
        let (first, build_secs) = time_process(|| build(self.stage.mesh(), HURRY));
        let first = first?;
        let lesson = Lesson::cast(&Shoot::new(self.stage, mode, view, &plan), &first, 0, (view, self.frame));
        Ok(Lesson { secs: build_secs + lesson.secs, ..lesson })
    }

    /// The rays of an earlier frame. They were cast for that frame's picture, so they cost nothing more.
    fn previous(&self, view: &View, mode: Mode, frames: u32) -> Result<Lesson, String> {
        let lesson = match path_view(self.entry, &view.name, frames)? {
            Some(earlier) => self.looking_from(&earlier, mode, self.plan.training),
            None => self.earlier_frame(view, mode, frames)?,
        };
        Ok(Lesson { secs: 0.0, ..lesson })
    }

    /// The same view of the scene as it was.
    fn earlier_frame(&self, view: &View, mode: Mode, frames: u32) -> Result<Lesson, String> {
        let too_early = || format!("frame {} of '{}' has no frame {frames} before it", self.frame, view.name);
        let frame = self.frame.checked_sub(frames).ok_or_else(too_early)?;
        let scene = (self.load)(self.entry, frame).map_err(|e| e.to_string())?;
        let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
        drop(scene);
        let first = build(stage.mesh(), &Spec::default().to_string())?;
        Ok(Site { frame, stage: &stage, first: &first, ..*self }.looking_from(view, mode, self.plan.training))
    }

    /// As many rays as one view would give, from all views alike.
    fn all_views(&self, mode: Mode) -> Lesson {
        let each = self.plan.training.div_ceil(self.views.len().max(1));
        let lessons: Vec<Lesson> = self.views.iter().map(|view| self.looking_from(view, mode, each)).collect();
        let samples = lessons.iter().flat_map(|l| l.training.samples().to_vec()).collect();
        // In the order of their hashes, so that every prefix is a fair mixture.
        let training = Training::from_samples(Profile::from_samples(samples, self.plan.seed).samples().to_vec());
        let secs = lessons.iter().map(|l| l.secs).sum();
        Lesson { training, secs, view: "all".to_owned(), frame: self.frame }
    }
}

fn build(mesh: &Mesh, spec: &str) -> Result<Accel, String> {
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let spec: Spec = spec.parse().map_err(|e: rdh::Error| e.to_string())?;
    rdh::build(mesh, &spec, &Training::none(), &options).map_err(|e| e.to_string())
}
