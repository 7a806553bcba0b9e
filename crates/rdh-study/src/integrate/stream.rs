//! The rays of a view: test batches, and training samples.

use std::collections::BTreeMap;

use rayon::prelude::*;
use rdh::{Accel, Query, Ray, RayClass, Recorder, Training};
use rdh_scene::View;

use super::caster::{Keeping, Recording};
use super::film::Film;
use super::lens::Lens;
use super::mode::Mode;
use super::random::derived_seed;
use super::stage::Stage;
use crate::plan::{Plan, Protocol};

/// Rays of one class that ask the same, in film order; the rays of one path are in the order in which they were cast.
#[derive(Debug, Clone, PartialEq)]
pub struct RayBatch {
    /// What they are for.
    pub class: RayClass,
    /// What is asked of each.
    pub query: Query,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// All that decides the rays of a view in a mode. They don't depend on the structure they are made with, nor on threads.
#[derive(Debug, Clone, Copy)]
pub struct Shoot<'a> {
    stage: &'a Stage,
    mode: Mode,
    lens: Lens,
    test: Film,
    training: usize,
    training_seed: u64,
    protocol: Protocol,
}

/// Film samples that one task follows.
const CHUNK: usize = 2048;

type ByClass = BTreeMap<(RayClass, Query), Vec<Ray>>;

impl<'a> Shoot<'a> {
    /// The rays of `plan` for one view and mode.
    pub fn new(stage: &'a Stage, mode: Mode, view: &View, plan: &Plan) -> Self {
        let [columns, rows] = mode.film(plan.size);
        let lens = Lens::new(stage, mode, view, plan.size[0] as f64 / plan.size[1] as f64);
        let test = Film { columns, rows, seed: derived_seed(plan.seed, u64::from(b'B')) };
        let training_seed = derived_seed(plan.seed, u64::from(b'A'));
        Self { stage, mode, lens, test, training: plan.training, training_seed, protocol: plan.protocol }
    }

    /// The test rays, by class and query; classes without rays have no batch. Runs on rayon's current threads.
    pub fn batches(&self, accel: &Accel) -> Vec<RayBatch> {
        let starts: Vec<usize> = (0..self.test.len()).step_by(CHUNK).collect();
        let follow = |&start: &usize| {
            let mut keeping = Keeping { accel, rays: ByClass::new() };
            for index in start..(start + CHUNK).min(self.test.len()) {
                self.follow(&self.test, index, &mut keeping);
            }
            keeping.rays
        };
        let chunks: Vec<ByClass> = starts.par_iter().map(follow).collect();
        let mut all = ByClass::new();
        for ((class, query), rays) in chunks.into_iter().flatten() {
            all.entry((class, query)).or_default().extend(rays);
        }
        all.into_iter().map(|((class, query), rays)| RayBatch { class, query, rays }).collect()
    }

    /// The training rays, cast on this thread: all rays of the paths that start at the training positions, of which the
    /// recorder keeps a fair sample of at most the plan's number, over all classes together. [`Protocol::Same`] keeps
    /// all rays; their number is that of the test rays.
    pub fn training(&self, accel: &Accel, test_rays: usize) -> Training {
        let (film, cells, capacity) = match self.protocol {
            Protocol::Unseen => {
                let film = Film::of_about(self.training, self.training_seed);
                (film, (0..film.len()).collect::<Vec<_>>(), self.training)
            }
            Protocol::Paper => (self.test, self.test.subset(self.training, self.training_seed), self.training),
            Protocol::Same => (self.test, (0..self.test.len()).collect(), test_rays),
        };
        let recorder = Recorder::new(capacity, self.training_seed);
        let mut recording = Recording { accel, recorder: &recorder };
        for index in cells {
            self.follow(&film, index, &mut recording);
        }
        Training::from_samples(recorder.into_profile().samples().to_vec())
    }

    fn follow(&self, film: &Film, index: usize, caster: &mut impl super::caster::Caster) {
        let mut sample = film.sample(index);
        let ray = self.lens.ray(sample.x, sample.y);
        self.mode.trace(self.stage, &ray, &mut sample.random, caster);
    }
}
