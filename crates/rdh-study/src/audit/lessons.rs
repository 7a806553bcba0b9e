//! What is tuned by: the rays of each class at a view, and profiles that no application should hand in, but some will.

use rdh::{Accel, HeldOut, Profile, Query, Ray, RayClass, RaySample, Training, Unseen};
use rdh_scene::View;

use crate::bench::{Column, Film, Frame};
use crate::integrate::{Lens, Mode, Stage};

/// Rays to learn from, to choose by, and to judge by.
#[derive(Debug)]
pub(super) struct Lesson {
    pub(super) name: &'static str,
    pub(super) training: Training,
    pub(super) held_out: HeldOut,
    pub(super) unseen: Unseen,
    pub(super) promise: Promise,
}

/// What must be true of the choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Promise {
    /// On unseen rays it is not slower than any structure by areas.
    NotSlower,
    /// It says that there are too few rays, and keeps areas.
    TooFew,
    /// It is judged by other rays than it was chosen for: if it is slower there, [`Profile::drift`] says that they are others.
    NotSlowerOrWarned(Drifted),
}

/// What drift says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drifted {
    pub(super) distance: f64,
    pub(super) p_value: f64,
}

/// The classes that are audited. Tiles are the same rays as rows.
const CLASSES: [Column; 4] = [Column::Rows, Column::Shadow, Column::Bounce, Column::Ao];

/// The rays of one view.
pub(super) struct Seen {
    by_class: Vec<(Column, Vec<RaySample>)>,
    seed: u64,
}

impl Seen {
    /// Casts all classes through a structure of the stage.
    pub(super) fn of(stage: &Stage, accel: &Accel, view: &View, size: usize, seed: u64) -> Self {
        let lens = Lens::new(stage, Mode::Primary, view, 1.0);
        let frame = Frame::new(stage, accel, &lens, Film { size, jitter: true, seed });
        let sample = |column: Column| {
            let of = move |ray| RaySample::new(ray, accel.closest(&ray), column.query(), column.class());
            (column, frame.rays(column).into_iter().map(of).collect())
        };
        Self { by_class: CLASSES.into_iter().map(sample).collect(), seed }
    }

    fn all(&self) -> Vec<RaySample> {
        self.by_class.iter().flat_map(|(_, samples)| samples).copied().collect()
    }

    fn primary(&self) -> &[RaySample] {
        &self.by_class[0].1
    }

    fn profile(&self, samples: Vec<RaySample>) -> Profile {
        Profile::from_samples(samples, self.seed)
    }
}

impl Lesson {
    /// The usual way: a profile, split.
    fn split(name: &'static str, profile: Profile) -> Self {
        let (training, held_out, unseen) = profile.split(1);
        Self { name, training, held_out, unseen, promise: Promise::NotSlower }
    }

    /// All three sets at once: what comes past [`Profile`], which would have refused it.
    fn forced(name: &'static str, samples: &[RaySample], promise: Promise) -> Self {
        let (training, held_out) = (Training::from_samples(samples.to_vec()), HeldOut::from_samples(samples.to_vec()));
        Self { name, training, held_out, unseen: Unseen::from_samples(samples.to_vec()), promise }
    }
}

/// A lesson for each class, and one for all together.
pub(super) fn usual(seen: &Seen) -> Vec<Lesson> {
    let name = |column: Column| if column == Column::Rows { "primary" } else { column.name() };
    let alone = seen.by_class.iter().map(|(column, of)| Lesson::split(name(*column), seen.profile(of.clone())));
    alone.chain([Lesson::split("all", seen.profile(seen.all()))]).collect()
}

/// What an application should not hand in. `other` are rays of another view, if there is one.
pub(super) fn adversarial(seen: &Seen, other: Option<&Seen>, stage: &Stage) -> Vec<Lesson> {
    let primary = seen.primary();
    let one = &primary[primary.len() / 2..][..1];
    let faulty: Vec<RaySample> = primary.iter().enumerate().map(|(i, s)| spoilt(s, i)).collect();
    let mut lessons = vec![
        Lesson::forced("one ray", one, Promise::TooFew),
        Lesson::forced("invalid rays", &faulty, Promise::TooFew),
        Lesson::forced("one ray, often", &one.repeat(4096), Promise::TooFew),
        Lesson::split("no length", seen.profile(primary.iter().map(of_no_length).collect())),
        Lesson::split("past the scene", seen.profile(primary.iter().map(|s| past(s, stage)).collect())),
        Lesson::split("mostly past", seen.profile(mostly_past(primary, stage))),
        Lesson::split("mixed, weighed", seen.profile(weighed(seen.all()))),
        Lesson::split("few", seen.profile(seen.all()).thin(4 * 400)),
    ];
    if let Some(other) = other {
        lessons.extend(moved(seen, other));
    }
    lessons
}

/// The camera moves: before the rays are recorded, between learning and choosing, or afterwards.
fn moved(seen: &Seen, other: &Seen) -> Vec<Lesson> {
    let [here, there] = [seen, other].map(|from| from.profile(from.all()));
    let drift = there.drift(&here).map(|d| Drifted { distance: d.distance, p_value: d.p_value });
    let learnt_there = || Lesson::split("another view", there.clone());
    let (_, held_out, unseen) = here.split(1);
    let judged_here = Lesson { name: "moved since", unseen: unseen.clone(), ..learnt_there() };
    let chosen_here = Lesson { name: "moved while learning", held_out, unseen, ..learnt_there() };
    let warned = |drifted| Lesson { promise: Promise::NotSlowerOrWarned(drifted), ..judged_here };
    [learnt_there(), chosen_here].into_iter().chain(drift.map(warned)).collect()
}

/// A ray that can't be cast, of all kinds in turn.
fn spoilt(sample: &RaySample, i: usize) -> RaySample {
    let mut ray = sample.ray;
    match i % 4 {
        0 => ray.origin[i % 3] = f32::NAN,
        1 => ray.direction = [0.0; 3],
        2 => ray.direction[i % 3] = f32::INFINITY,
        _ => (ray.t_min, ray.t_max) = (1.0, 0.0),
    }
    RaySample { ray, ..*sample }
}

fn of_no_length(sample: &RaySample) -> RaySample {
    let t = sample.t_hit.unwrap_or(1.0);
    RaySample { ray: sample.ray.within(t, t), ..*sample }
}

/// The same ray so far away that it meets nothing.
fn past(sample: &RaySample, stage: &Stage) -> RaySample {
    let far = stage.bounds().diagonal() * 4.0;
    let ray =
        Ray { origin: sample.ray.origin.map(|x| x + far), direction: sample.ray.direction.map(f32::abs), ..sample.ray };
    RaySample { ray, t_hit: None, ..*sample }
}

/// One ray in a hundred meets the scene: nearly all costs come from few rays.
fn mostly_past(primary: &[RaySample], stage: &Stage) -> Vec<RaySample> {
    primary.iter().enumerate().map(|(i, s)| if i % 100 == 0 { *s } else { past(s, stage) }).collect()
}

/// Any class, any query, and weights of which a few are large.
fn weighed(mut samples: Vec<RaySample>) -> Vec<RaySample> {
    for (i, sample) in samples.iter_mut().enumerate() {
        (sample.class, sample.query) = (RayClass::ALL[i % 8], Query::ALL[i / 8 % 3]);
        sample.weight = match i {
            i if i % 997 == 0 => 1000,
            i => 1 + i as u32 % 5,
        };
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::{BuildOptions, Spec};

    #[test]
    fn lessons_are_what_their_names_say() {
        let entry = rdh_scene::catalog::find("rooms", &[]).unwrap();
        let stage = Stage::new(&entry.load(0).unwrap()).unwrap();
        let accel = rdh::build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        let seen = |view: usize| Seen::of(&stage, &accel, &entry.views[view], 32, 1);
        let (here, there) = (seen(0), seen(1));
        let lessons = adversarial(&here, Some(&there), &stage);
        let of = |name: &str| lessons.iter().find(|l| l.name == name).unwrap();
        assert!(of("invalid rays").held_out.samples().iter().all(|s| !s.ray.is_valid()));
        for name in ["no length", "past the scene"] {
            assert!(of(name).unseen.samples().iter().all(|s| s.ray.is_valid()), "{name}");
        }
        assert!(of("past the scene").unseen.samples().iter().all(|s| accel.closest(&s.ray).is_none()));
        assert!(of("few").held_out.len() >= 256);
        assert!(matches!(of("moved since").promise, Promise::NotSlowerOrWarned(d) if d.p_value < 0.01));
        assert_eq!(of("moved since").training, of("another view").training);
        assert_eq!(of("moved while learning").unseen, of("moved since").unseen);
        assert_eq!(
            usual(&here).iter().map(|l| l.name).collect::<Vec<_>>(),
            ["primary", "shadow", "bounce", "ao", "all"]
        );
    }
}
