//! Builds of a scene's structures, timed.

use rdh::{Accel, BuildOptions, Mesh, Spec, Training};
use rdh_scene::View;

use crate::clock::{time_process, time_thread};
use crate::integrate::Shoot;
use crate::stats::median;

/// Rays to learn from, where they come from, and what they cost.
#[derive(Debug, Clone)]
pub struct Lesson {
    /// The rays.
    pub training: Training,
    /// One thread's CPU time of casting and recording them.
    pub secs: f64,
    /// The view that they were cast from.
    pub view: String,
    /// The frame that they were cast in.
    pub frame: u32,
}

/// A finished structure and what it took.
#[derive(Debug)]
pub struct Built {
    /// What it is.
    pub spec: Spec,
    /// The structure.
    pub accel: Accel,
    /// One thread's CPU time: the median of the builds.
    pub build_secs: f64,
    /// One thread's CPU time for the rays it was built for; 0 without.
    pub rrs_secs: f64,
    /// View and frame of those rays.
    pub trained_at: Option<(String, u32)>,
}

impl Lesson {
    /// No rays, at no cost.
    pub fn none() -> Self {
        Self { training: Training::none(), secs: 0.0, view: String::new(), frame: 0 }
    }

    /// Casts and records training rays of a view at a frame through a tree, on this thread; `test_rays` as in [`Shoot::training`].
    pub fn cast(shoot: &Shoot<'_>, accel: &Accel, test_rays: usize, (view, frame): (&View, u32)) -> Self {
        let (training, secs) = time_thread(|| shoot.training(accel, test_rays));
        Self { training, secs, view: view.name.clone(), frame }
    }
}

impl Built {
    fn new(spec: Spec, lesson: &Lesson, accel: Accel, build_secs: f64) -> Self {
        let trained = spec.needs_rays();
        Self {
            spec,
            accel,
            build_secs,
            rrs_secs: if trained { lesson.secs } else { 0.0 },
            trained_at: trained.then(|| (lesson.view.clone(), lesson.frame)),
        }
    }
}

/// Builds structures one after the other, on one thread each, and all of them `times` times in turn, so that whatever drifts meets
/// all alike. What can't be built is a reason.
pub fn build_interleaved(mesh: &Mesh, wanted: &[(Spec, &Lesson)], times: usize) -> Vec<Result<Built, String>> {
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let mut accels: Vec<Option<Result<Accel, String>>> = wanted.iter().map(|_| None).collect();
    let mut secs = vec![Vec::new(); wanted.len()];
    for round in 0..times {
        for turn in 0..wanted.len() {
            let i = (turn + round) % wanted.len();
            if matches!(accels[i], Some(Err(_))) {
                continue;
            }
            // The old one goes first: two of a large scene's trees would not fit.
            accels[i] = None;
            let (spec, lesson) = &wanted[i];
            let (accel, time) = time_process(|| rdh::build(mesh, spec, &lesson.training, &options));
            accels[i] = Some(accel.map_err(|e| e.to_string()));
            secs[i].push(time);
        }
    }
    let finished = wanted.iter().zip(accels).zip(&secs).filter_map(|((&(spec, lesson), accel), secs)| {
        Some(accel?.map(|accel| Built::new(spec, lesson, accel, median(secs))))
    });
    finished.collect()
}
